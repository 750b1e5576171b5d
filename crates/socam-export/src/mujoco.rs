use crate::{Exported, description::Description, error::ExportError};
pub(crate) fn write(_d: &Description<'_>) -> Result<Exported, ExportError> {
    Err(ExportError::Xml(String::new()))
}
