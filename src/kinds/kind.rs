//! Kinds of devices and tools, from which a program is assembled.

use crate::app::{DeviceKind, KindRegistry, ToolKind};
use crate::buses::bridge::sim::AttachableKind;
use crate::cli::{CliCommand, Commands, DeviceCommands, ProtocolDecoder};
use crate::profile::{ProfileFormat, ProfileFormats};
use crate::ui::{DeviceView, TabViews, ToolView};

#[derive(Clone, Copy)]
pub struct Kind {
    pub view: &'static dyn DeviceView,
    pub commands: &'static dyn DeviceCommands,
    /// Virtual device for the virtual adapter, or `None` for a kind that does not use the adapter. The adapter offers
    /// only the built-in list (`kinds::attachable_kinds`), which does not contain external kinds.
    pub at_adapter: Option<&'static dyn AttachableKind>,
}

#[derive(Clone, Copy)]
pub struct ToolTab {
    pub view: &'static dyn ToolView,
}

/// A program, made up of the device kinds and tools that its window and command line offer.
#[derive(Clone, Copy)]
pub struct Program {
    pub studio: KindRegistry,
    pub tabs: TabViews,
    pub commands: Commands,
}

impl Program {
    /// Creates a program from device kinds and tools, in the order in which the navigation and the help list them.
    /// `protocols` adds protocols to decode, and `further` adds commands to those of the devices. The lists are never
    /// freed.
    pub fn new(
        kinds: &[Kind],
        tools: &[ToolTab],
        protocols: &'static [&'static dyn ProtocolDecoder],
        further: &'static [&'static dyn CliCommand],
    ) -> Self {
        let devices: Vec<&'static dyn DeviceKind> = kinds.iter().map(|kind| kind.view.kind()).collect();
        let formats: Vec<&'static dyn ProfileFormat> = devices.iter().map(|kind| kind.profile_format()).collect();
        let tool_kinds: Vec<&'static dyn ToolKind> = tools.iter().map(|tool| tool.view.kind()).collect();
        let views: Vec<&'static dyn DeviceView> = kinds.iter().map(|kind| kind.view).collect();
        let tool_views: Vec<&'static dyn ToolView> = tools.iter().map(|tool| tool.view).collect();
        let commands: Vec<&'static dyn DeviceCommands> = kinds.iter().map(|kind| kind.commands).collect();
        Program {
            studio: KindRegistry::new(ProfileFormats::new(formats.leak()), devices.leak(), tool_kinds.leak()),
            tabs: TabViews::new(views.leak(), tool_views.leak()),
            commands: Commands::new(commands.leak(), protocols, further),
        }
    }
}
