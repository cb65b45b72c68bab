//! Execution of actions in the connection dialog.

use super::context::{FinderContext, FinderRequests};
use super::form::AnyForm;
use super::{ConnectAction, ConnectDialog, list_ports};
use crate::app::payload::{Payload, PayloadKindError};
use crate::app::studio::Studio;
use crate::app::tab::Tab;
use crate::app::{FileQuestion, Text};

impl Studio {
    pub(in crate::app) fn apply_connect_action(&mut self, action: ConnectAction) {
        match action {
            ConnectAction::Open => {
                let kinds = self.services.world.kinds;
                let tab = Some(self.settings.tab).filter(|tab| kinds.kind_for_tab(*tab).is_some());
                let shown = || self.selected_device().map(|device| device.tab());
                let device = tab.or_else(shown).unwrap_or_else(|| kinds.first_tab());
                // The dialog initially shows the most recently used link.
                let last = |tab| self.settings.links_of(tab).first().and_then(|link| link.parse().ok());
                self.connect = Some(ConnectDialog::new(kinds, device, last));
                self.list_ports();
            }
            ConnectAction::Close => self.close_dialog(),
            ConnectAction::ListPorts => {
                if let Some(connect) = &mut self.connect {
                    connect.ports = None;
                    self.list_ports();
                }
            }
            ConnectAction::Device(device) => {
                self.end_finder();
                self.edit_dialog(|connect| (connect.device, connect.typed) = (device, None));
                self.list_ports();
            }
            ConnectAction::Edit(entries) => self.apply_entries(entries),
            ConnectAction::Find(action) => self.find(action),
            ConnectAction::Use(link) => self.edit_dialog(|connect| connect.set_typed_link(link)),
            ConnectAction::AskRecording => self.services.file_question = Some(FileQuestion::Recording),
            ConnectAction::Recording(path) => self.edit_dialog(|connect| {
                connect.forms_mut().for_each(|form| form.set_file(path.display().to_string()));
                connect.typed = None;
            }),
            ConnectAction::Connect => {
                let Some(connect) = &mut self.connect else { return };
                let device = connect.device;
                match connect.url() {
                    Ok(url) => {
                        // A search may still occupy the connection.
                        self.close_dialog();
                        self.open_link(device, url);
                    }
                    Err(problem) => self.show_problem(problem),
                }
            }
            ConnectAction::StopSearch => {
                if let Some(connect) = &mut self.connect {
                    connect.stop();
                }
            }
        }
    }

    fn edit_dialog(&mut self, edit: impl FnOnce(&mut ConnectDialog)) {
        if let Some(connect) = &mut self.connect {
            edit(connect);
            connect.problem = None;
        }
    }

    fn apply_entries(&mut self, entries: Payload) {
        let Some(connect) = &mut self.connect else { return };
        let form = connect.forms_mut().find(|form| form.accepts_entries(&entries));
        if form.is_none_or(|form| form.replace_entries(entries).is_err()) {
            return self.notify_wrong_kind(None);
        }
        self.edit_dialog(|connect| connect.typed = None);
    }

    fn find(&mut self, action: Payload) {
        let is_its = |form: &dyn AnyForm| form.is_finder_action(&action);
        let Some((tab, place)) = self.form_index(is_its) else {
            // If the dialog has been closed, the result is ignored.
            if self.connect.is_some() {
                self.notify_wrong_kind(None);
            }
            return;
        };
        let mut fills_in = Ok(false);
        self.with_form_context(tab, place, |form, context| fills_in = form.find(action, context));
        match fills_in {
            Ok(true) => self.edit_dialog(|connect| connect.typed = None),
            Ok(false) => {}
            Err(PayloadKindError) => self.notify_wrong_kind(None),
        }
    }

    /// Continues the search once the user has confirmed that there is no other master on the line.
    pub(in crate::app) fn start_confirmed_search(&mut self, tab: Tab) {
        let at = |connect: &ConnectDialog| connect.forms.iter().position(|(own, _)| *own == tab);
        if let Some(place) = self.connect.as_ref().and_then(at) {
            self.with_form_context(tab, place, |form, context| form.handle_confirmation(context));
        }
    }

    pub(in crate::app) fn handle_finder_result(&mut self, tab: Tab, done: Payload) {
        let Some(kind) = self.services.world.kinds.kind_for_tab(tab) else { return self.notify_wrong_kind(None) };
        let forms = self.connect.as_mut().map(|connect| &mut connect.forms);
        let form = forms.and_then(|forms| forms.iter_mut().find(|(own, _)| *own == tab));
        let form = form.map(|(_, form)| form.as_mut() as &mut dyn AnyForm);
        if kind.handle_finder_result(form, done, &mut self.services).is_err() {
            self.notify_wrong_kind(None);
        }
    }

    fn form_index(&self, is_it: impl Fn(&dyn AnyForm) -> bool) -> Option<(Tab, usize)> {
        let forms = &self.connect.as_ref()?.forms;
        forms.iter().enumerate().find_map(|(at, (tab, form))| is_it(form.as_ref()).then_some((*tab, at)))
    }

    /// Calls `act` with a form and the resources for a search, and then carries out what the search has requested.
    fn with_form_context(
        &mut self,
        tab: Tab,
        place: usize,
        act: impl FnOnce(&mut dyn AnyForm, &mut FinderContext<'_>),
    ) {
        let Some(mut connect) = self.connect.take() else { return };
        let link = connect.url();
        let mut context = FinderContext::new(self, tab, link);
        if let Some((_, form)) = connect.forms.get_mut(place) {
            act(form.as_mut(), &mut context);
        }
        let FinderRequests { found, problem } = context.into_requests();
        connect.problem = problem;
        self.connect = Some(connect);
        if let Some(url) = found {
            self.close_dialog();
            self.open_discovered(tab, url);
        }
    }

    /// Starts listing the serial ports. Ports previously used for the current kind of device are listed first.
    fn list_ports(&self) {
        if let Some(connect) = &self.connect {
            list_ports(&self.services, self.settings.links_of(connect.device));
        }
    }

    fn show_problem(&mut self, problem: Text) {
        if let Some(connect) = &mut self.connect {
            connect.problem = Some(problem);
        }
    }

    fn end_finder(&mut self) {
        if let Some(connect) = &mut self.connect {
            connect.forms_mut().for_each(|form| drop(form.finish(&mut self.services)));
        }
    }

    pub(in crate::app) fn close_dialog(&mut self) {
        self.end_finder();
        self.connect = None;
    }
}
