//! Reading of a description in any syntax.

use crate::error::{Result, RobotError};
use crate::tree::Robot;
use crate::{mjcf, sdf, urdf};

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
