//! The connection form of a kind of device, and what looks for such devices from there: typed in the device's folder,
//! object-safe for the dialog. One adapter stands between the two.

#![warn(missing_docs)]

use std::any::Any;
use std::marker::PhantomData;

use crossbeam_channel::Receiver;

use super::context::FinderContext;
use crate::app::Text;
use crate::app::payload::{Payload, WrongKind};
use crate::app::services::Services;
use crate::link::LinkUrl;

/// A link to a kind of device as entries to be filled in. Entries of another way to the device are kept.
pub trait FormModel: Clone + PartialEq + Send + 'static {
    /// The search for devices of the form; [`NoFinder`] for none.
    type Finder: Finder<Form = Self>;

    /// Returns the link to the virtual device that the window begins with.
    fn usual() -> LinkUrl;

    /// Returns the form filled in as a link says.
    fn from_url(url: &LinkUrl) -> Self;

    /// Returns the link that the entries stand for. What is as usual is left out.
    ///
    /// # Errors
    /// A sentence that says which entry cannot be used and what would be allowed.
    fn url(&self) -> Result<LinkUrl, Text>;

    /// Fills in the file of a recording.
    fn set_file(&mut self, _file: String) {}

    /// Returns what a link to such a device looks like.
    fn example(&self) -> &'static str;
}

/// Looks for devices from a connection form: on its line, or in the network.
pub trait Finder: Default + 'static {
    /// The form that it fills in.
    type Form;
    /// The actions of the search.
    type Action: Any + Send;
    /// The results of its tasks.
    type Done: Any + Send;

    /// Carries out an action.
    fn act(&mut self, action: Self::Action, form: &mut Self::Form, context: &mut FinderContext<'_>);

    /// Handles the result of a task; `None` where the dialog was closed meanwhile.
    fn done(finder: Option<&mut Self>, done: Self::Done, services: &mut Services);

    /// Goes on after the user has confirmed that no other master is on the line.
    fn confirmed(&mut self, _context: &mut FinderContext<'_>) {}

    /// Looks what has happened since the last time.
    fn pump(&mut self) {}

    /// Returns whether it holds the wire of the form.
    fn is_running(&self) -> bool {
        false
    }

    /// Stops.
    fn stop(&mut self) {}

    /// Ends and forgets what it found. The channel, where there is one, closes when the wire is free.
    fn end(&mut self, _services: &mut Services) -> Option<Receiver<()>> {
        None
    }
}

/// Looks for nothing.
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

/// The form of a kind of device, as the dialog uses it. Implemented for every [`FormModel`].
pub trait AnyForm {
    /// Returns the entries.
    fn form(&self) -> &dyn Any;
    /// Returns what looks for devices.
    fn finder(&self) -> &dyn Any;
    /// Returns what looks for devices, to be changed.
    fn finder_mut(&mut self) -> &mut dyn Any;
    /// Returns the link that the entries stand for.
    ///
    /// # Errors
    /// A sentence that says which entry cannot be used and what would be allowed.
    fn url(&self) -> Result<LinkUrl, Text>;
    /// Fills in the entries as a link says.
    fn take(&mut self, url: &LinkUrl);
    /// Fills in the file of a recording.
    fn set_file(&mut self, file: String);
    /// Returns what a link to such a device looks like.
    fn example(&self) -> &'static str;
    /// Returns whether these are entries of this form.
    fn is_of_form(&self, entries: &Payload) -> bool;
    /// Returns whether this is an action of its finder.
    fn is_of_finder(&self, action: &Payload) -> bool;
    /// Takes edited entries.
    ///
    /// # Errors
    /// They are of another kind of device.
    fn edit(&mut self, entries: Payload) -> Result<(), WrongKind>;
    /// Passes an action to the finder. Returns whether it has filled in the form.
    ///
    /// # Errors
    /// The action is of another kind of device.
    fn find(&mut self, action: Payload, context: &mut FinderContext<'_>) -> Result<bool, WrongKind>;
    /// Goes on after the user has confirmed that no other master is on the line.
    fn confirmed(&mut self, context: &mut FinderContext<'_>);
    /// Looks what its finder has come to.
    fn pump(&mut self);
    /// Returns whether its finder holds the wire.
    fn is_running(&self) -> bool;
    /// Stops its finder.
    fn stop(&mut self);
    /// Ends its finder. The channel, where there is one, closes when the wire is free.
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
