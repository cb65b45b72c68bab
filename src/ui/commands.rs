//! Named actions of the window, for the keyboard and the command palette. Each action is listed once, with its text,
//! its key and whether it is available. Motion is excluded, because it requires a button to be held.

use std::time::Duration;

use egui::{Key, KeyboardShortcut, Modifiers};

use super::backups::time;
use super::device_view::DeviceView;
use super::{Theme, Views};
use crate::app::session::Phase;
use crate::app::{
    Action, AnyDevice, ColorScheme, CompanyAction, DeviceCommand, Language, LibraryAction, RecorderOwner, ServerAction,
    SessionId, Studio, Tab, Text, connect,
};
use crate::store::{Backup, UserName};

const COMMAND: Modifiers = Modifiers::COMMAND;
const COMMAND_SHIFT: Modifiers = Modifiers { shift: true, ..Modifiers::COMMAND };

/// Key that toggles the help, even while a dialog is open.
pub(super) const HELP_KEY: Key = Key::F1;

/// Keys that select the tabs in combination with Ctrl, in tab order.
const TAB_KEYS: [Key; 9] =
    [Key::Num1, Key::Num2, Key::Num3, Key::Num4, Key::Num5, Key::Num6, Key::Num7, Key::Num8, Key::Num9];

pub(super) struct Command {
    /// Name of the device or tab that the command affects. Empty for a command that affects the whole program.
    pub(super) about: String,
    pub(super) name: String,
    /// Name in the language that is not selected. The command palette also finds the command by this name.
    pub(super) other_name: String,
    pub(super) shortcut: Option<KeyboardShortcut>,
    /// Whether a focused text entry receives the key instead of the command.
    pub(super) yields_to_typing: bool,
    pub(super) is_enabled: bool,
    pub(super) effect: CommandEffect,
}

pub(super) enum CommandEffect {
    Act(Action),
    Page(SessionId, usize),
    ToolPage(Tab, usize),
    ToggleHelp,
    About,
    ResetLayout,
}

/// A named action of one kind of device, offered in the command palette.
pub struct NamedAction {
    pub name: String,
    pub is_enabled: bool,
    pub action: Action,
}

/// Returns the commands that have a shortcut. Shortcuts with more modifiers come first, because they could otherwise be
/// mistaken for those with fewer.
pub(super) fn shortcut_commands(theme: &Theme, studio: &Studio, views: &Views) -> Vec<Command> {
    let mut commands = program_commands(theme, studio, views);
    if let Some(device) = studio.selected_device().filter(|device| device.tab() == studio.settings.tab) {
        let has_undo_keys = views.tabs.device(device.tab()).is_some_and(DeviceView::has_undo_keys);
        let of_device = common_device_commands(theme, device, views).into_iter();
        commands.extend(of_device.filter(|command| has_undo_keys || !command.yields_to_typing));
    }
    commands.retain(|command| command.shortcut.is_some());
    commands.sort_by_key(|command| command.shortcut.is_some_and(|keys| !keys.modifiers.shift));
    commands
}

/// Returns all commands, with their names in both languages.
pub(super) fn all_commands(theme: &Theme, studio: &Studio, views: &Views) -> Vec<Command> {
    let mut commands = in_language(theme, studio, views);
    let others = in_language(&theme.with_toggled_language(), studio, views);
    for (own, other) in commands.iter_mut().zip(others) {
        own.other_name = other.name;
    }
    commands
}

fn in_language(theme: &Theme, studio: &Studio, views: &Views) -> Vec<Command> {
    let mut commands = Vec::new();
    if let Some(device) = studio.selected_device() {
        commands.extend(common_device_commands(theme, device, views));
        if let Some(view) = views.tabs.device(device.tab()) {
            let own = view.named_actions(theme, device).into_iter();
            commands.extend(own.map(|NamedAction { name, is_enabled, action }| Command {
                is_enabled,
                ..Command::new(device.name(), name, CommandEffect::Act(action))
            }));
        }
        commands.extend(backups(theme, device));
        commands.extend(write_commands(theme, studio, device));
    }
    for device in studio.devices() {
        let pages = views.tabs.pages(device.tab()).into_iter().enumerate();
        commands.extend(pages.map(|(at, page)| {
            Command::new(device.name(), theme.translate(page.word), CommandEffect::Page(device.id(), at))
        }));
    }
    for tool in views.tabs.tool_views() {
        let (tab, title) = (tool.kind().tab(), theme.translate(tool.title()));
        let pages = tool.pages().into_iter().enumerate();
        commands.extend(
            pages.map(|(at, page)| Command::new(&title, theme.translate(page.word), CommandEffect::ToolPage(tab, at))),
        );
        let report = CommandEffect::Act(Action::AskReport(RecorderOwner::Tool(tab)));
        commands.push(Command::new(&title, theme.translate("shell.report"), report).enabled_if(studio.can_report(tab)));
    }
    commands.extend(program_commands(theme, studio, views));
    commands
}

fn program_commands(theme: &Theme, studio: &Studio, views: &Views) -> Vec<Command> {
    let command = |word: &'static str, effect| Command::new("", theme.translate(word), effect);
    let act = |word: &'static str, action| command(word, CommandEffect::Act(action));
    let mut commands = vec![
        act("shell.open", Action::AskOpen).with_shortcut(COMMAND, Key::O),
        act("shell.profiles", Action::Library(LibraryAction::Open)),
        act("shell.connect", Action::Connect(connect::ConnectAction::Open)),
        act("shell.virtual_device", Action::OpenVirtual),
        act(if studio.has_drives() { "shell.stop_all" } else { "shell.stop" }, Action::Stop)
            .enabled_if(studio.is_moving() || studio.can_stop() || studio.has_control()),
    ];
    let keys = TAB_KEYS.into_iter().map(Some).chain(std::iter::repeat_with(|| None));
    commands.extend(views.tabs.tabs().zip(keys).map(|(tab, key)| {
        let shown = Command::new("", views.tabs.title(theme, tab), CommandEffect::Act(Action::ShowTab(tab)));
        Command { shortcut: key.map(|key| KeyboardShortcut::new(COMMAND, key)), ..shown }
    }));
    let settings = &studio.settings;
    commands.push(match settings.theme {
        ColorScheme::Dark => act("shell.light", Action::SetTheme(ColorScheme::Light)),
        ColorScheme::Light => act("shell.dark", Action::SetTheme(ColorScheme::Dark)),
    });
    commands.push(match settings.language {
        Language::English => act("shell.language", Action::SetLanguage(Language::German)),
        Language::German => act("shell.language", Action::SetLanguage(Language::English)),
    });
    for (name, word) in [
        (UserName::Full, "shell.user_name"),
        (UserName::Initials, "shell.user_initials"),
        (UserName::Off, "shell.user_off"),
    ] {
        commands.push(act(word, Action::SetUserName(name)).enabled_if(name != settings.user_name));
    }
    commands.push(act("shell.logbook_server", Action::Server(ServerAction::Open)));
    commands.push(act("shell.company", Action::Company(CompanyAction::Open)));
    let (word, opens) = if settings.lower_open { ("status_line.close", false) } else { ("status_line.open", true) };
    commands.push(act(word, Action::OpenLowerPanel(opens)).with_shortcut(COMMAND, Key::T));
    commands.push(command("shell.help", CommandEffect::ToggleHelp).with_shortcut(Modifiers::NONE, HELP_KEY));
    commands.push(command("shell.about", CommandEffect::About));
    commands.push(command("shell.reset_layout", CommandEffect::ResetLayout));
    commands
}

fn common_device_commands(theme: &Theme, device: &AnyDevice, views: &Views) -> Vec<Command> {
    let act =
        |word: &'static str, action| Command::new(device.name(), theme.translate(word), CommandEffect::Act(action));
    let ask = |word: &'static str, command| act(word, device.command(command));
    let is_offline = *device.phase() == Phase::Offline;
    let live = if device.is_polling() {
        ask("palette.live_pause", DeviceCommand::Poll(None))
    } else {
        let every = Duration::from_micros(views.rate);
        ask("palette.live_start", DeviceCommand::Poll(Some(every))).enabled_if(device.is_ready())
    };
    vec![
        ask("palette.read_again", DeviceCommand::Read)
            .with_shortcut(Modifiers::NONE, Key::F5)
            .enabled_if(device.is_readable()),
        ask("memory.review", DeviceCommand::Review)
            .with_shortcut(COMMAND, Key::Enter)
            .enabled_if(!is_offline && device.is_dirty()),
        act("shell.save", Action::Save(device.id())).with_shortcut(COMMAND, Key::S).enabled_if(device.is_savable()),
        ask("profile_card.save_as", DeviceCommand::AskSave)
            .with_shortcut(COMMAND_SHIFT, Key::S)
            .enabled_if(device.is_savable()),
        ask("shell.restore", DeviceCommand::AskRestore).enabled_if(device.is_ready() && device.has_memory()),
        ask("shell.compare", DeviceCommand::AskCompare).enabled_if(device.is_comparable()),
        ask("shell.report", DeviceCommand::AskReport).enabled_if(device.is_comparable()),
        ask("memory.undo", DeviceCommand::Undo)
            .with_shortcut(COMMAND, Key::Z)
            .disable_while_typing()
            .enabled_if(device.can_undo()),
        ask("memory.redo", DeviceCommand::Redo)
            .with_shortcut(COMMAND_SHIFT, Key::Z)
            .disable_while_typing()
            .enabled_if(device.can_redo()),
        ask("memory.redo", DeviceCommand::Redo)
            .with_shortcut(COMMAND, Key::Y)
            .disable_while_typing()
            .enabled_if(device.can_redo()),
        ask("memory.revert", DeviceCommand::RevertAll).enabled_if(device.is_dirty()),
        ask("live.once", DeviceCommand::ReadPosition).enabled_if(device.is_ready()),
        live,
        ask("shell.reconnect", DeviceCommand::Reconnect).enabled_if(!is_offline && !device.is_writing()),
        act("shell.close_session", Action::CloseSession(device.id())),
    ]
}

fn backups(theme: &Theme, device: &AnyDevice) -> Vec<Command> {
    let Some(Ok(backups)) = device.backups() else { return Vec::new() };
    let restore = |backup: &Backup| {
        let text = Text::new("palette.restore_backup").with("time", time(backup.taken));
        let action = device.command(DeviceCommand::Restore(backup.path.clone()));
        Command::new(device.name(), theme.format_text(&text), CommandEffect::Act(action)).enabled_if(device.is_ready())
    };
    backups.iter().map(restore).collect()
}

/// Returns the commands that write an open profile to connected devices of the same kind.
fn write_commands(theme: &Theme, studio: &Studio, device: &AnyDevice) -> Vec<Command> {
    let is_target = |other: &&AnyDevice| other.tab() == device.tab() && *other.phase() == Phase::Connected;
    let write = |target: &AnyDevice| {
        let text = Text::new("palette.write_into").with("device", target.name());
        let action = device.command(DeviceCommand::WriteInto(target.id()));
        Command::new(device.name(), theme.format_text(&text), CommandEffect::Act(action)).enabled_if(target.is_ready())
    };
    let is_profile = *device.phase() == Phase::Offline;
    studio.devices().iter().map(Box::as_ref).filter(is_target).filter(|_| is_profile).map(write).collect()
}

impl NamedAction {
    /// Creates an action with the same name as its button. `word` is a text id in the common catalogue.
    pub fn new(theme: &Theme, word: &'static str, is_enabled: bool, action: Action) -> Self {
        NamedAction { name: theme.translate(word), is_enabled, action }
    }
}

impl Command {
    fn new(about: impl Into<String>, name: String, effect: CommandEffect) -> Self {
        let about = about.into();
        let other_name = String::new();
        Command { about, name, other_name, shortcut: None, yields_to_typing: false, is_enabled: true, effect }
    }

    fn with_shortcut(self, modifiers: Modifiers, key: Key) -> Self {
        Command { shortcut: Some(KeyboardShortcut::new(modifiers, key)), ..self }
    }

    fn disable_while_typing(self) -> Self {
        Command { yields_to_typing: true, ..self }
    }

    fn enabled_if(self, is_enabled: bool) -> Self {
        Command { is_enabled, ..self }
    }
}
