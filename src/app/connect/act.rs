//! The connection dialog, carried out.

use super::{Action, Connect, list_ports};
use crate::app::FileQuestion;
use crate::app::Text;
use crate::app::studio::Studio;
use crate::app::tab::Tab;

impl Studio {
    pub(in crate::app) fn act_connect(&mut self, action: Action) {
        match action {
            Action::Open => {
                let device = match self.settings.tab {
                    Tab::Signals => self.shown().map_or(Tab::Hiperface, |device| device.tab()),
                    tab => tab,
                };
                // What was used before comes first.
                let last = |tab| self.settings.links(tab).first().and_then(|link| link.parse().ok());
                self.connect = Some(Connect::new(device, last));
                self.list_ports();
            }
            Action::Close => self.close_dialog(),
            Action::ListPorts => {
                if let Some(connect) = &mut self.connect {
                    connect.ports = None;
                    self.list_ports();
                }
            }
            Action::Device(device) => {
                self.end_search();
                self.edit(|connect| (connect.device, connect.search, connect.typed) = (device, None, None));
                self.list_ports();
            }
            Action::Edit(form) => self.edit(|connect| (connect.form, connect.typed) = (*form, None)),
            Action::EditBiss(form) => self.edit(|connect| (connect.biss, connect.typed) = (*form, None)),
            Action::EditSsi(form) => self.edit(|connect| (connect.ssi, connect.typed) = (*form, None)),
            Action::EditInterbus(form) => self.edit(|connect| (connect.interbus, connect.typed) = (*form, None)),
            Action::EditHiperdrive(form) => self.edit(|connect| (connect.hiperdrive, connect.typed) = (*form, None)),
            Action::Discover => self.discover(),
            Action::ChooseDevice(at) => self.choose_device(at),
            Action::Use(link) => self.edit(|connect| connect.take(link)),
            Action::AskRecording => self.services.file_question = Some(FileQuestion::Recording),
            Action::Recording(path) => self.edit(|connect| {
                let path = path.display().to_string();
                (connect.form.file, connect.biss.file) = (path.clone(), path.clone());
                (connect.ssi.file, connect.interbus.file) = (path.clone(), path.clone());
                connect.hiperdrive.file = path;
                connect.typed = None;
            }),
            Action::Connect => {
                let Some(connect) = &mut self.connect else { return };
                let device = connect.device;
                match connect.url() {
                    Ok(url) => {
                        // A search may still hold the wire.
                        self.close_dialog();
                        self.open_link(device, url);
                    }
                    Err(problem) => self.refuse(problem),
                }
            }
            Action::Search(options) => self.search_for(options),
            Action::StopSearch => {
                if let Some(search) = self.connect.as_mut().and_then(|connect| connect.search.as_mut()) {
                    search.stop();
                }
            }
            Action::Choose(at) => self.choose(at),
        }
    }

    fn edit(&mut self, edit: impl FnOnce(&mut Connect)) {
        if let Some(connect) = &mut self.connect {
            edit(connect);
            connect.problem = None;
        }
    }

    /// Looks for the serial ports; those used before for this kind of device come first.
    fn list_ports(&self) {
        if let Some(connect) = &self.connect {
            list_ports(&self.services, self.settings.links(connect.device));
        }
    }

    pub(crate) fn refuse(&mut self, problem: Text) {
        if let Some(connect) = &mut self.connect {
            connect.problem = Some(problem);
        }
    }

    /// Closes the dialog; its search ends.
    pub(crate) fn close_dialog(&mut self) {
        self.end_search();
        self.connect = None;
    }
}
