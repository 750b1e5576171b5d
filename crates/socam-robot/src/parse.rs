//! Reading of a description or of settings in any syntax.

use crate::controller::Controller;
use crate::error::{Result, RobotError};
use crate::settings::Settings;
use crate::tree::Robot;
use crate::{mjcf, moteus, odrive, sdf, urdf};

impl Robot {
    /// Reads a description. `include` gives the text of a file that it names.
    ///
    /// # Errors
    /// One sentence with the line, where it has one.
    pub fn parse(text: &str, include: &dyn Fn(&str) -> Option<String>) -> Result<Self> {
        let options =
            roxmltree::ParsingOptions { allow_dtd: false, nodes_limit: 1_000_000, ..Default::default() };
        let document = roxmltree::Document::parse_with_options(text, options)?;
        let root = document.root_element();
        match root.tag_name().name() {
            "robot" => urdf::read(root),
            "mujoco" => mjcf::read(root, include),
            "sdf" | "gazebo" | "world" | "model" => sdf::read(root),
            other => Err(RobotError::Whole(format!(
                "begins with <{other}>; expected <robot> of URDF, <mujoco> of MJCF or <sdf>"
            ))),
        }
    }
}

impl Controller {
    /// Reads settings: lines of `moteus_tool --dump-config`, or the JSON of `odrivetool backup-config`, of which `axis` names one axis.
    ///
    /// # Errors
    /// One sentence with the line or the setting.
    pub fn parse(text: &str, axis: Option<&str>) -> Result<Self> {
        if text.trim_start_matches('\u{feff}').trim_start().starts_with('{') {
            return odrive::read(&Settings::json(text)?, axis);
        }
        let controller = moteus::read(&Settings::lines(text)?)?;
        match axis {
            Some(axis) if axis != controller.name => Err(RobotError::Whole(format!(
                "is of one axis, `{}`, and has no `{axis}`; leave out --joint",
                controller.name
            ))),
            _ => Ok(controller),
        }
    }
}
