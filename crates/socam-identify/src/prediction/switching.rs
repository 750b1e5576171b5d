//! Switches of the integrator between the modes of a gear with play.

use crate::prediction::{
    event::SwitchingEvent, hybrid_modes::Play, instant::Instant, integrator::Integrator,
};

impl Integrator<'_> {
    /// Whether the twist in the mesh leaves the mode's range at a node of the step that was found.
    pub(super) fn leaves_mode(&self) -> bool {
        let (n, ports) = (self.dimensions.states, self.dimensions.ports);
        let Some(Play { port, .. }) = self.hybrid_modes.play else { return false };
        let [low, high] = self.hybrid_modes.modes[self.mode].range;
        (0..4).any(|node| !(low..=high).contains(&self.ends[n + node * ports + port]))
    }

    /// Switches to the mode in whose range the twist in the mesh is at the end of a step, if that is another mode.
    pub(super) fn switch(&mut self) -> Option<SwitchingEvent> {
        let (n, ports, inputs) = (self.dimensions.states, self.dimensions.ports, self.dimensions.inputs);
        let Play { port, .. } = self.hybrid_modes.play?;
        let [low, high] = self.hybrid_modes.modes[self.mode].range;
        let (twist, rate) = (self.port_inputs[ports + port], self.port_inputs[ports + port + 1]);
        let (next, boundary) = match twist {
            _ if twist < low => (self.mode - 1, low),
            _ if twist > high => (self.mode + 1, high),
            _ => return None,
        };
        let held = self.xi[n + 2 * inputs..][..inputs].to_vec();
        let before = self.instant(&held);
        let late_s = (twist - boundary) / rate;
        // A twist that grazes the boundary, or crosses it twice within the shortest step, is not corrected.
        let late_s = if (0.0..=2.0 * self.hybrid_modes.finest_s).contains(&late_s) { late_s } else { 0.0 };
        self.mode = next;
        self.solve_forces(&held);
        let beyond = self.instant(&held);
        let rates = |instant: &Instant| self.hybrid_modes.dynamics(instant.mode).rates(instant);
        let jump: Vec<f64> =
            rates(&before).iter().zip(rates(&beyond)).map(|(before, beyond)| before - beyond).collect();
        self.xi.iter_mut().zip(&jump).for_each(|(x, jump)| *x -= late_s * jump);
        self.solve_forces(&held);
        Some(SwitchingEvent { before, beyond, after: self.instant(&held), late_s, rate, jump })
    }
}
