//! What a board knows of a direct-current motor that it compares with the motor's encoder.

/// A motor whose voltage, current and speed are channels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct MotorWatch {
    /// Channel of the motor's speed.
    pub speed: u8,
    /// Channel of the motor's current.
    pub current: u8,
    /// Channel of the voltage at the motor.
    pub voltage: u8,
    /// Channel of the supply's voltage.
    pub supply: u8,
    /// Resistance of the winding with bridge and leads: uV per uA, in 1/2^16.
    pub resistance_q16: i32,
    /// uV per urad/s, in 1/2^24.
    pub back_emf_q24: i32,
    /// Longest time of a contradiction between encoder and winding.
    pub after_us: u32,
    /// Lowest voltage of the supply.
    pub lowest_supply_uv: i32,
}

impl MotorWatch {
    /// Whether a board can use it with these channels.
    pub(crate) fn is_sound(&self, channel_count: u8) -> bool {
        [self.speed, self.current, self.voltage, self.supply].iter().all(|channel| *channel < channel_count)
            && self.resistance_q16 > 0
            && self.back_emf_q24 > 0
            && self.after_us > 0
            && self.lowest_supply_uv >= 0
    }
}
