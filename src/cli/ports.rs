//! The `ports` command, which lists the serial ports of this computer.

use serde_json::{Value as Json, json};

use super::output::{Lines, Output};
use super::runner::to_failure;
use super::{Result, Success};
use crate::app::explain;
use crate::link;

pub(super) fn ports(output: &Output) -> Result {
    let ports = link::ports().map_err(|error| to_failure(&explain::link_error_text(&error)))?;
    let list: Vec<Json> = ports
        .iter()
        .map(|port| json!({"path": port.path, "description": port.description, "serial_number": port.serial_number}))
        .collect();
    let mut lines = Lines::default();
    for port in &ports {
        lines.add_line(&port.path, &port.description);
    }
    let text = if ports.is_empty() { "no serial ports\n".to_owned() } else { lines.text() };
    output.show(&json!({ "ports": list }), &text)?;
    Ok(Success::Completed)
}
