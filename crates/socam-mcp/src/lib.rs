//! A server of the Model Context Protocol (<https://modelcontextprotocol.io>) over stdin and stdout, whose tools are the commands of
//! `socam-host`.
//!
//! [`serve`] lists the tools of [`tools`] with schemas made from the description of options that command line, Python and window share
//! ([`socam_job::options`]). A call runs the program as a process of its own, so that an answer is the document that the command prints
//! with `--json`, a cancelled call ends the process, and no call can bring the server down. Without a folder to write into, no tool
//! writes a file.

mod call;
mod error;
mod schema;
mod server;
mod tools;

pub use error::{McpError, Result};
pub use server::{Settings, serve};
