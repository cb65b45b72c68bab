//! The connection dialog, carried out.

use super::{Action, Connect, LinkForm, Search, list_ports};
use crate::app::action::Done;
use crate::app::line::Line;
use crate::app::studio::Studio;
use crate::app::{Text, explain};
use crate::device::hiperface::find::FindOptions;
use crate::link::LinkUrl;

impl Studio {
    pub(in crate::app) fn act_connect(&mut self, action: Action) {
        match action {
            Action::Open => {
                // What was used before comes first.
                let last = self.settings.links().first().and_then(|link| link.parse().ok());
                self.connect = Some(Connect::new(LinkForm::from_url(&last.unwrap_or_else(LinkUrl::sim))));
                list_ports(&self.services);
            }
            Action::Close => self.connect = None,
            Action::ListPorts => {
                if let Some(connect) = &mut self.connect {
                    connect.ports = None;
                    list_ports(&self.services);
                }
            }
            Action::Edit(form) => self.edit(*form),
            Action::Use(link) => match link.parse::<LinkUrl>() {
                Ok(url) => self.edit(LinkForm::from_url(&url)),
                Err(error) => self.refuse(Text::new("link.url").with_text("why", explain::url(&error))),
            },
            Action::Connect => {
                let Some(connect) = &mut self.connect else { return };
                match connect.form.url() {
                    Ok(url) => {
                        // A search may still hold the wire.
                        let holder = connect.search.take().and_then(|search| search.line).map(Line::into_worker);
                        self.connect = None;
                        self.open_link_after(url, holder);
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

    fn edit(&mut self, form: LinkForm) {
        if let Some(connect) = &mut self.connect {
            connect.form = form;
            connect.problem = None;
        }
    }

    fn refuse(&mut self, problem: Text) {
        if let Some(connect) = &mut self.connect {
            connect.problem = Some(problem);
        }
    }

    fn search_for(&mut self, options: FindOptions) {
        let Some(connect) = &mut self.connect else { return };
        let url = match connect.form.url() {
            Ok(url) => url,
            Err(problem) => {
                connect.problem = Some(problem);
                return;
            }
        };
        let old = connect.search.take().and_then(|search| search.line).map(Line::into_worker);
        let number = self.new_search();
        let search = Search { number, url: url.clone(), options, line: None, found: Vec::new(), end: None };
        if let Some(connect) = &mut self.connect {
            connect.search = Some(search);
        }
        let done = move |result| Done::OpenedForSearch { number, result };
        self.open_task(url, old.into_iter().collect(), Vec::new(), done);
    }

    fn choose(&mut self, at: usize) {
        let Some(search) = self.connect.as_mut().and_then(|connect| connect.search.take()) else { return };
        let Some(url) = search.found.get(at).map(|found| search.link_to(found)) else { return };
        self.connect = None;
        self.open_link_after(url, search.line.map(Line::into_worker));
    }
}
