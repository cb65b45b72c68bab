//! Kinds of devices and tools, and the assembly of a program from them.

use crate::app::{DeviceKind, Kinds, ToolKind};
use crate::buses::bridge::sim::Attachable;
use crate::cli::{Commands, DeviceCommands, OwnCommand, ProtocolDecoder};
use crate::profile::{Formats, ProfileFormat};
use crate::ui::{DeviceView, TabViews, ToolView};

/// A kind of device: its pages, with its state and its profiles, and its commands.
#[derive(Clone, Copy)]
pub struct Kind {
    pub view: &'static dyn DeviceView,
    pub commands: &'static dyn DeviceCommands,
    /// Virtual device on the virtual adapter; `None` for a kind that does not use an adapter. The adapter uses the
    /// program's own list (`kinds::at_adapter`): a kind from outside is not on it.
    pub at_adapter: Option<&'static dyn Attachable>,
}

/// A tab that needs no device.
#[derive(Clone, Copy)]
pub struct ToolTab {
    pub view: &'static dyn ToolView,
}

/// The kinds of devices and the tools, as the studio, the window and the command line take them.
#[derive(Clone, Copy)]
pub struct Program {
    pub studio: Kinds,
    pub tabs: TabViews,
    pub commands: Commands,
}

impl Program {
    /// Creates a program with these kinds of devices and tools, in the order of the navigation and of the help; `protocols`
    /// can be decoded too, and `further` commands are added to those of devices. The lists remain in memory as long as the
    /// process runs.
    pub fn new(
        kinds: &[Kind],
        tools: &[ToolTab],
        protocols: &'static [&'static dyn ProtocolDecoder],
        further: &'static [&'static dyn OwnCommand],
    ) -> Self {
        let devices: Vec<&'static dyn DeviceKind> = kinds.iter().map(|kind| kind.view.kind()).collect();
        let formats: Vec<&'static dyn ProfileFormat> = devices.iter().map(|kind| kind.format()).collect();
        let tool_kinds: Vec<&'static dyn ToolKind> = tools.iter().map(|tool| tool.view.kind()).collect();
        let views: Vec<&'static dyn DeviceView> = kinds.iter().map(|kind| kind.view).collect();
        let tool_views: Vec<&'static dyn ToolView> = tools.iter().map(|tool| tool.view).collect();
        let commands: Vec<&'static dyn DeviceCommands> = kinds.iter().map(|kind| kind.commands).collect();
        Program {
            studio: Kinds::new(Formats::new(formats.leak()), devices.leak(), tool_kinds.leak()),
            tabs: TabViews::new(views.leak(), tool_views.leak()),
            commands: Commands::new(commands.leak(), protocols, further),
        }
    }
}
