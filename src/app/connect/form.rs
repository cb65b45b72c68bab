//! The connection form of a kind of device, and the search for devices. Each kind of device implements both with its
//! own types. An adapter passes them to the dialog as trait objects.

#![warn(missing_docs)]

use std::any::Any;
use std::marker::PhantomData;

use crossbeam_channel::Receiver;

use super::context::FinderContext;
use crate::app::Text;
use crate::app::payload::{Payload, PayloadKindError};
use crate::app::services::Services;
use crate::link::LinkUrl;

/// A form that defines a link to a kind of device. Entries for other types of connection are preserved.
pub trait FormModel: Clone + PartialEq + Send + 'static {
    /// The search for devices, or [`NoFinder`] if the form does not support one.
    type Finder: Finder<Form = Self>;

    /// Returns the link to the virtual device, which initialises the form.
    fn default_link() -> LinkUrl;

    /// Fills in a new form from a link.
    fn from_url(url: &LinkUrl) -> Self;

    /// Builds the link from the entries, omitting default values.
    ///
    /// # Errors
    /// Returns a message that names the invalid entry and the allowed values.
    fn url(&self) -> Result<LinkUrl, Text>;

    /// Sets the path of a recording.
    fn set_file(&mut self, _file: String) {}

    /// Returns an example link to show as a hint.
    fn example_link(&self) -> &'static str;
}

/// A search for devices on a serial line or in the network, started from a connection form.
pub trait Finder: Default + 'static {
    /// The form that the search fills in.
    type Form;
    /// The user's actions in the search.
    type Action: Any + Send;
    /// The results of tasks that the search starts.
    type TaskResult: Any + Send;

    /// Executes a user action in the search.
    fn handle_action(&mut self, action: Self::Action, form: &mut Self::Form, context: &mut FinderContext<'_>);

    /// Handles the result of a task. `finder` is `None` if the dialog has since been closed.
    fn handle_result(finder: Option<&mut Self>, done: Self::TaskResult, services: &mut Services);

    /// Continues the search once the user has confirmed that there is no other master on the line.
    fn handle_confirmation(&mut self, _context: &mut FinderContext<'_>) {}

    /// Processes all events received since the last call.
    fn process_events(&mut self) {}

    /// Returns whether the search is using the form's connection.
    fn is_running(&self) -> bool {
        false
    }

    /// Stops the search.
    fn stop(&mut self) {}

    /// Ends the search and discards its results. The connection is free as soon as the returned channel, if any,
    /// closes.
    fn finish(&mut self, _services: &mut Services) -> Option<Receiver<()>> {
        None
    }
}

/// The finder of a form that does not support searching for devices.
pub struct NoFinder<F>(PhantomData<fn() -> F>);

impl<F> Default for NoFinder<F> {
    fn default() -> Self {
        NoFinder(PhantomData)
    }
}

impl<F: 'static> Finder for NoFinder<F> {
    type Form = F;
    type Action = std::convert::Infallible;
    type TaskResult = std::convert::Infallible;

    fn handle_action(&mut self, action: Self::Action, _form: &mut F, _context: &mut FinderContext<'_>) {
        match action {}
    }

    fn handle_result(_finder: Option<&mut Self>, done: Self::TaskResult, _services: &mut Services) {
        match done {}
    }
}

/// The object-safe interface of a connection form, implemented for every [`FormModel`].
pub trait AnyForm {
    /// Returns the form for downcasting.
    fn as_any_form(&self) -> &dyn Any;
    /// Returns the finder for downcasting.
    fn as_any_finder(&self) -> &dyn Any;
    /// Returns the finder for downcasting, mutably.
    fn finder_mut(&mut self) -> &mut dyn Any;
    /// Builds the link from the entries, omitting default values.
    ///
    /// # Errors
    /// Returns a message that names the invalid entry and the allowed values.
    fn url(&self) -> Result<LinkUrl, Text>;
    /// Fills in the entries from a link.
    fn fill_from_link(&mut self, url: &LinkUrl);
    /// Sets the path of a recording.
    fn set_file(&mut self, file: String);
    /// Returns an example link to show as a hint.
    fn example_link(&self) -> &'static str;
    /// Returns whether the payload contains the entries of this kind of form.
    fn accepts_entries(&self, entries: &Payload) -> bool;
    /// Returns whether the payload contains an action of this form's finder.
    fn is_finder_action(&self, action: &Payload) -> bool;
    /// Replaces the entries with edited ones.
    ///
    /// # Errors
    /// Returns an error if the entries belong to a different kind of device.
    fn replace_entries(&mut self, entries: Payload) -> Result<(), PayloadKindError>;
    /// Passes an action to the finder. Returns whether the form has changed.
    ///
    /// # Errors
    /// Returns an error if the action belongs to a different kind of device.
    fn find(&mut self, action: Payload, context: &mut FinderContext<'_>) -> Result<bool, PayloadKindError>;
    /// Continues the search once the user has confirmed that there is no other master on the line.
    fn handle_confirmation(&mut self, context: &mut FinderContext<'_>);
    /// Processes pending events of the finder.
    fn process_events(&mut self);
    /// Returns whether the finder is using the connection.
    fn is_running(&self) -> bool;
    /// Stops the finder.
    fn stop(&mut self);
    /// Ends the search. The connection is free as soon as the returned channel, if any, closes.
    fn finish(&mut self, services: &mut Services) -> Option<Receiver<()>>;
}

/// Adapter from [`FormModel`] to [`AnyForm`].
pub(in crate::app) struct FormModelAdapter<F: FormModel> {
    form: F,
    finder: F::Finder,
}

impl<F: FormModel> FormModelAdapter<F> {
    pub(in crate::app) fn new(link: &LinkUrl) -> Self {
        FormModelAdapter { form: F::from_url(link), finder: F::Finder::default() }
    }
}

impl<F: FormModel> AnyForm for FormModelAdapter<F> {
    fn as_any_form(&self) -> &dyn Any {
        &self.form
    }

    fn as_any_finder(&self) -> &dyn Any {
        &self.finder
    }

    fn finder_mut(&mut self) -> &mut dyn Any {
        &mut self.finder
    }

    fn url(&self) -> Result<LinkUrl, Text> {
        self.form.url()
    }

    fn fill_from_link(&mut self, url: &LinkUrl) {
        self.form = F::from_url(url);
    }

    fn set_file(&mut self, file: String) {
        self.form.set_file(file);
    }

    fn example_link(&self) -> &'static str {
        self.form.example_link()
    }

    fn accepts_entries(&self, entries: &Payload) -> bool {
        entries.contains::<F>()
    }

    fn is_finder_action(&self, action: &Payload) -> bool {
        action.contains::<<F::Finder as Finder>::Action>()
    }

    fn replace_entries(&mut self, entries: Payload) -> Result<(), PayloadKindError> {
        self.form = entries.open()?;
        Ok(())
    }

    fn find(&mut self, action: Payload, context: &mut FinderContext<'_>) -> Result<bool, PayloadKindError> {
        let before = self.form.clone();
        self.finder.handle_action(action.open()?, &mut self.form, context);
        Ok(self.form != before)
    }

    fn handle_confirmation(&mut self, context: &mut FinderContext<'_>) {
        self.finder.handle_confirmation(context);
    }

    fn process_events(&mut self) {
        self.finder.process_events();
    }

    fn is_running(&self) -> bool {
        self.finder.is_running()
    }

    fn stop(&mut self) {
        self.finder.stop();
    }

    fn finish(&mut self, services: &mut Services) -> Option<Receiver<()>> {
        self.finder.finish(services)
    }
}
