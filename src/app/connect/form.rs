//! The connection form of a kind of device, and its search for devices: typed in the device's folder, object-safe for the
//! dialog. One adapter connects the two.

#![warn(missing_docs)]

use std::any::Any;
use std::marker::PhantomData;

use crossbeam_channel::Receiver;

use super::context::FinderContext;
use crate::app::Text;
use crate::app::payload::{Payload, WrongKind};
use crate::app::services::Services;
use crate::link::LinkUrl;

/// Link to a kind of device as entries. Entries of another kind of connection are kept.
pub trait FormModel: Clone + PartialEq + Send + 'static {
    /// The search for devices of the form; [`NoFinder`] for none.
    type Finder: Finder<Form = Self>;

    /// Returns the link to the virtual device that the window begins with.
    fn usual() -> LinkUrl;

    /// Returns the form filled in from a link.
    fn from_url(url: &LinkUrl) -> Self;

    /// Returns the link of the entries. Default values are left out.
    ///
    /// # Errors
    /// A sentence that names the invalid entry and the allowed values.
    fn url(&self) -> Result<LinkUrl, Text>;

    /// Fills in the file of a recording.
    fn set_file(&mut self, _file: String) {}

    /// Returns an example of a link to such a device.
    fn example(&self) -> &'static str;
}

/// Searches for devices from a connection form: on its line, or in the network.
pub trait Finder: Default + 'static {
    /// The form that it fills in.
    type Form;
    /// The actions of the search.
    type Action: Any + Send;
    /// The results of its tasks.
    type Done: Any + Send;

    /// Carries out an action.
    fn act(&mut self, action: Self::Action, form: &mut Self::Form, context: &mut FinderContext<'_>);

    /// Handles the result of a task; `None` if the dialog was closed meanwhile.
    fn done(finder: Option<&mut Self>, done: Self::Done, services: &mut Services);

    /// Continues after the user has confirmed that no other master is on the line.
    fn confirmed(&mut self, _context: &mut FinderContext<'_>) {}

    /// Takes in all events since the last call.
    fn pump(&mut self) {}

    /// Returns whether it holds the wire of the form.
    fn is_running(&self) -> bool {
        false
    }

    /// Stops.
    fn stop(&mut self) {}

    /// Ends the search and forgets its results. The channel, if any, closes when the connection is free.
    fn end(&mut self, _services: &mut Services) -> Option<Receiver<()>> {
        None
    }
}

/// No search.
pub struct NoFinder<F>(PhantomData<fn() -> F>);

impl<F> Default for NoFinder<F> {
    fn default() -> Self {
        NoFinder(PhantomData)
    }
}

impl<F: 'static> Finder for NoFinder<F> {
    type Form = F;
    type Action = std::convert::Infallible;
    type Done = std::convert::Infallible;

    fn act(&mut self, action: Self::Action, _form: &mut F, _context: &mut FinderContext<'_>) {
        match action {}
    }

    fn done(_finder: Option<&mut Self>, done: Self::Done, _services: &mut Services) {
        match done {}
    }
}

/// Form of a kind of device, as used by the dialog. Implemented for every [`FormModel`].
pub trait AnyForm {
    /// Returns the entries.
    fn form(&self) -> &dyn Any;
    /// Returns the search.
    fn finder(&self) -> &dyn Any;
    /// Returns the search, to be changed.
    fn finder_mut(&mut self) -> &mut dyn Any;
    /// Returns the link of the entries.
    ///
    /// # Errors
    /// A sentence that names the invalid entry and the allowed values.
    fn url(&self) -> Result<LinkUrl, Text>;
    /// Fills in the entries from a link.
    fn take(&mut self, url: &LinkUrl);
    /// Fills in the file of a recording.
    fn set_file(&mut self, file: String);
    /// Returns an example of a link to such a device.
    fn example(&self) -> &'static str;
    /// Returns whether these are entries of this form.
    fn is_of_form(&self, entries: &Payload) -> bool;
    /// Returns whether this is an action of its search.
    fn is_of_finder(&self, action: &Payload) -> bool;
    /// Takes edited entries.
    ///
    /// # Errors
    /// They are of another kind of device.
    fn edit(&mut self, entries: Payload) -> Result<(), WrongKind>;
    /// Passes an action to the search. Returns whether it has filled in the form.
    ///
    /// # Errors
    /// The action is of another kind of device.
    fn find(&mut self, action: Payload, context: &mut FinderContext<'_>) -> Result<bool, WrongKind>;
    /// Continues after the user has confirmed that no other master is on the line.
    fn confirmed(&mut self, context: &mut FinderContext<'_>);
    /// Takes in the events of its search.
    fn pump(&mut self);
    /// Returns whether its search holds the connection.
    fn is_running(&self) -> bool;
    /// Stops its search.
    fn stop(&mut self);
    /// Ends its search. The channel, if any, closes when the connection is free.
    fn end(&mut self, services: &mut Services) -> Option<Receiver<()>>;
}

/// The adapter from [`FormModel`] to [`AnyForm`].
pub(in crate::app) struct Filled<F: FormModel> {
    form: F,
    finder: F::Finder,
}

impl<F: FormModel> Filled<F> {
    pub(in crate::app) fn new(link: &LinkUrl) -> Self {
        Filled { form: F::from_url(link), finder: F::Finder::default() }
    }
}

impl<F: FormModel> AnyForm for Filled<F> {
    fn form(&self) -> &dyn Any {
        &self.form
    }

    fn finder(&self) -> &dyn Any {
        &self.finder
    }

    fn finder_mut(&mut self) -> &mut dyn Any {
        &mut self.finder
    }

    fn url(&self) -> Result<LinkUrl, Text> {
        self.form.url()
    }

    fn take(&mut self, url: &LinkUrl) {
        self.form = F::from_url(url);
    }

    fn set_file(&mut self, file: String) {
        self.form.set_file(file);
    }

    fn example(&self) -> &'static str {
        self.form.example()
    }

    fn is_of_form(&self, entries: &Payload) -> bool {
        entries.is::<F>()
    }

    fn is_of_finder(&self, action: &Payload) -> bool {
        action.is::<<F::Finder as Finder>::Action>()
    }

    fn edit(&mut self, entries: Payload) -> Result<(), WrongKind> {
        self.form = entries.open()?;
        Ok(())
    }

    fn find(&mut self, action: Payload, context: &mut FinderContext<'_>) -> Result<bool, WrongKind> {
        let before = self.form.clone();
        self.finder.act(action.open()?, &mut self.form, context);
        Ok(self.form != before)
    }

    fn confirmed(&mut self, context: &mut FinderContext<'_>) {
        self.finder.confirmed(context);
    }

    fn pump(&mut self) {
        self.finder.pump();
    }

    fn is_running(&self) -> bool {
        self.finder.is_running()
    }

    fn stop(&mut self) {
        self.finder.stop();
    }

    fn end(&mut self, services: &mut Services) -> Option<Receiver<()>> {
        self.finder.end(services)
    }
}
