//! The server: its list of tools, and calls.

use std::{
    path::{Path, PathBuf},
    sync::Arc,
};

use base64::{Engine, engine::general_purpose::STANDARD};
use rmcp::{
    ErrorData, RoleServer, ServerHandler, ServiceExt,
    model::{
        CallToolRequestParams, CallToolResponse, CallToolResult, ContentBlock, Implementation,
        ListToolsResult, PaginatedRequestParams, ServerCapabilities, ServerConfig, ToolAnnotations,
    },
    service::RequestContext,
};
use serde_json::Value;

use crate::{
    call::{self, Answer},
    error::{McpError, Result},
    schema,
    tools::{TOOLS, Tool},
};

/// Exit codes of commands that have done their work: done, and done on recordings that lost samples.
const DONE: [i32; 2] = [0, 3];

/// Said to an agent when it begins.
const INSTRUCTIONS: &str = "\
socam records and models drivetrains: a motor, couplings, a reducer, sensors, a load. A job goes: `info` (channels, units), `check` (are the \
recordings fit), `model` (is the model file right; `template` has one to start from), `identify` (parameters with 95 % intervals), `diagnose` \
(physics that the model lacks, confirmed on held-out recordings), `design` (what to record next). Keep one recording out of every fit and give it \
as `holdout`. A value whose interval is null is not determined by the recordings: do not repeat it as known. Verdicts: `adequate` means that \
nothing material was found at the stated false-alarm rate, `unexplained` that the model misses something without a name, `not_judged` that \
nothing was judged. All values are in SI units.";

/// Settings of the server.
#[derive(Debug, Clone)]
pub struct Settings {
    /// The program whose commands are the tools.
    pub program: PathBuf,
    /// The folder that tools may write into; without one no tool writes.
    pub folder: Option<PathBuf>,
    /// Whether the program can draw pictures.
    pub has_pictures: bool,
}

/// Serves stdin and stdout until the client closes them. Calls that are under way then are ended.
///
/// # Errors
/// [`McpError::System`] without a runtime or streams, [`McpError::Protocol`] where the client does not begin as the protocol says.
pub fn serve(settings: Settings) -> Result<()> {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
    let runtime = runtime.map_err(McpError::system("cannot start"))?;
    let served = runtime.block_on(async {
        let server = Server { settings };
        let running = server.serve(rmcp::transport::stdio()).await;
        let running = running.map_err(|error| McpError::Protocol(error.to_string()))?;
        running.waiting().await.map_err(|error| McpError::Protocol(error.to_string()))?;
        Ok(())
    });
    // The thread that reads stdin does not end before its next line.
    runtime.shutdown_background();
    served
}

struct Server {
    settings: Settings,
}

impl ServerHandler for Server {
    fn get_info(&self) -> ServerConfig {
        let mut info = ServerConfig::new(ServerCapabilities::builder().enable_tools().build());
        info.server_info = Implementation::new("socam", env!("CARGO_PKG_VERSION"));
        info.with_instructions(INSTRUCTIONS)
    }

    async fn list_tools(
        &self,
        _: Option<PaginatedRequestParams>,
        _: RequestContext<RoleServer>,
    ) -> std::result::Result<ListToolsResult, ErrorData> {
        let tools: Result<Vec<rmcp::model::Tool>> = self.offered().map(|tool| self.listed(tool)).collect();
        let tools = tools.map_err(|error| ErrorData::internal_error(error.to_string(), None))?;
        Ok(ListToolsResult::with_all_items(tools))
    }

    async fn call_tool(
        &self,
        request: CallToolRequestParams,
        context: RequestContext<RoleServer>,
    ) -> std::result::Result<CallToolResponse, ErrorData> {
        let called = async {
            let tool = self.offered().find(|tool| tool.name == request.name);
            let tool = tool.ok_or_else(|| self.no_tool(&request.name))?;
            self.call(tool, request.arguments.unwrap_or_default()).await
        };
        let result = tokio::select! {
            result = called => result,
            () = context.ct.cancelled() => return Err(ErrorData::internal_error("the call was cancelled", None)),
        };
        // An agent reads the text of a result and not that of an error of the protocol.
        let result =
            result.unwrap_or_else(|error| CallToolResult::error(vec![ContentBlock::text(error.to_string())]));
        Ok(result.into())
    }
}

impl Server {
    fn folder(&self) -> Option<&Path> {
        self.settings.folder.as_deref()
    }

    /// The tools of this server.
    fn offered(&self) -> impl Iterator<Item = &'static Tool> + '_ {
        let has_pictures = self.settings.has_pictures;
        TOOLS
            .iter()
            .filter(move |tool| (has_pictures || !tool.is_picture) && schema::is_offered(tool, self.folder()))
    }

    fn no_tool(&self, name: &str) -> McpError {
        let known: Vec<&str> = self.offered().map(|tool| tool.name).collect();
        McpError::NoTool { name: name.into(), known: known.join(", ") }
    }

    fn listed(&self, tool: &Tool) -> Result<rmcp::model::Tool> {
        let schema = schema::schema(tool, self.folder())?;
        let writes = schema::arguments(tool, self.folder()).any(crate::tools::Argument::is_written);
        let annotations = ToolAnnotations::new().read_only(!writes).destructive(false).open_world(false);
        Ok(rmcp::model::Tool::new(tool.name, tool.about, Arc::new(schema)).with_annotations(annotations))
    }

    async fn call(&self, tool: &Tool, given: serde_json::Map<String, Value>) -> Result<CallToolResult> {
        let mut words = call::words(tool, given, self.folder())?;
        if !tool.is_picture {
            let answer = call::run(&self.settings.program, &words).await?;
            return Ok(result(&answer, None));
        }
        let folder = tempfile::tempdir().map_err(McpError::system("cannot make a folder for the picture"))?;
        let file = folder.path().join("picture.png");
        words.insert(1, format!("--screenshot={}", file.display()));
        let answer = call::run(&self.settings.program, &words).await?;
        Ok(result(&answer, std::fs::read(file).ok()))
    }
}

/// A command's answer as the result of a call: what it printed, a picture that it drew, and its messages.
fn result(answer: &Answer, picture: Option<Vec<u8>>) -> CallToolResult {
    let mut content = Vec::new();
    if let Some(picture) = picture {
        content.push(ContentBlock::image(STANDARD.encode(picture), "image/png"));
    }
    for text in [&answer.text, &answer.messages] {
        if !text.trim().is_empty() {
            content.push(ContentBlock::text(text.trim_end()));
        }
    }
    if content.is_empty() {
        content.push(ContentBlock::text("Done."));
    }
    // A command that judged nothing, or was told to stop, has an answer all the same.
    let is_done = answer.code.is_some_and(|code| DONE.contains(&code)) || !answer.text.trim().is_empty();
    if is_done { CallToolResult::success(content) } else { CallToolResult::error(content) }
}
