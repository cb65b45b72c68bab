//! The content of a profile, for any kind of device. A device module implements [`Profile`] for its own type. The
//! untyped traits used by documents are derived from it here.

use std::any::Any;
use std::fmt;
use std::marker::PhantomData;

use super::ron_text::{Entries, Writer};
use super::{ChangedItem, Comparison, ProfileError, Redo};

/// The profile type of one kind of device.
pub trait Profile: Clone + fmt::Debug + PartialEq + Send + Sync + 'static {
    /// Keyword for the kind of device on the command line and in profiles.
    const KIND: &'static str;

    /// Profile format of this kind, for use in [`ProfileFormats`].
    const FORMAT: &'static dyn ProfileFormat = &ProfileFormatAdapter::<Self>(PhantomData);

    /// A list of only this format, for code that accepts no other kind.
    const FORMATS: ProfileFormats = ProfileFormats::new(&[Self::FORMAT]);

    /// Parses the profile from the entries of a document.
    ///
    /// # Errors
    /// Returns an error that names the invalid entry.
    fn read(entries: &mut Entries) -> Result<Self, ProfileError>;

    /// Writes the entries of the profile to a document.
    fn write(&self, writer: &mut Writer);

    /// Compares this profile with another one.
    fn compare(&self, other: &Self) -> Comparison;

    /// Splits a changed item from the logbook into single values, such as bytes or registers. An undo compares these
    /// values one by one.
    fn single_values(item: &ChangedItem) -> Vec<ChangedItem> {
        vec![item.clone()]
    }

    /// Removes from a write's backup all values that the write did not change. By default, nothing is removed, because
    /// most kinds back up little more than the written values.
    fn keep_items(&mut self, _items: &[ChangedItem]) {}

    /// Returns what the user must do about a written item that cannot be restored from this backup.
    fn redo(&self, _item: &ChangedItem) -> Option<Redo> {
        None
    }
}

/// A parser for the profiles of one kind of device.
pub trait ProfileFormat: fmt::Debug + Sync {
    /// Returns the keyword for the kind of device.
    fn kind(&self) -> &'static str;

    /// Parses a profile.
    ///
    /// # Errors
    /// Returns an error that names the invalid entry.
    fn parse(&self, entries: &mut Entries) -> Result<Body, ProfileError>;
}

/// The untyped content of a profile. This trait is implemented for every [`Profile`].
pub trait ProfileBody: Any + fmt::Debug + Send + Sync {
    /// Returns the keyword for the kind of device.
    fn kind(&self) -> &'static str;

    /// Writes the entries of the profile to a document.
    fn emit(&self, writer: &mut Writer);

    /// Returns a boxed copy.
    fn clone_boxed(&self) -> Box<dyn ProfileBody>;

    /// Returns whether this body equals another one.
    fn dyn_eq(&self, other: &dyn ProfileBody) -> bool;

    /// Compares this body with another one. Returns `None` if the other body is for a different kind of device.
    fn compare_with(&self, other: &dyn ProfileBody) -> Option<Comparison>;

    /// Returns the function that splits a changed item from the logbook into single values.
    fn single_values(&self) -> fn(&ChangedItem) -> Vec<ChangedItem>;

    /// Removes from a write's backup all values that the write did not change.
    fn keep_items(&mut self, items: &[ChangedItem]);

    /// Returns what the user must do about a written item that cannot be restored from this backup.
    fn redo(&self, item: &ChangedItem) -> Option<Redo>;
}

impl<P: Profile> ProfileBody for P {
    fn kind(&self) -> &'static str {
        P::KIND
    }

    fn emit(&self, writer: &mut Writer) {
        self.write(writer);
    }

    fn clone_boxed(&self) -> Box<dyn ProfileBody> {
        Box::new(self.clone())
    }

    fn dyn_eq(&self, other: &dyn ProfileBody) -> bool {
        let other: &dyn Any = other;
        other.downcast_ref::<P>() == Some(self)
    }

    fn compare_with(&self, other: &dyn ProfileBody) -> Option<Comparison> {
        let other: &dyn Any = other;
        other.downcast_ref::<P>().map(|other| self.compare(other))
    }

    fn single_values(&self) -> fn(&ChangedItem) -> Vec<ChangedItem> {
        P::single_values
    }

    fn keep_items(&mut self, items: &[ChangedItem]) {
        Profile::keep_items(self, items);
    }

    fn redo(&self, item: &ChangedItem) -> Option<Redo> {
        Profile::redo(self, item)
    }
}

struct ProfileFormatAdapter<P>(PhantomData<fn() -> P>);

impl<P: Profile> fmt::Debug for ProfileFormatAdapter<P> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(P::KIND)
    }
}

impl<P: Profile> ProfileFormat for ProfileFormatAdapter<P> {
    fn kind(&self) -> &'static str {
        P::KIND
    }

    fn parse(&self, entries: &mut Entries) -> Result<Body, ProfileError> {
        P::read(entries).map(Body::new)
    }
}

/// The untyped content of a profile, for any kind of device.
pub struct Body(Box<dyn ProfileBody>);

impl Body {
    /// Wraps the profile of one kind of device.
    pub fn new<P: Profile>(profile: P) -> Self {
        Body(Box::new(profile))
    }

    /// Returns the keyword for the kind of device.
    pub fn kind(&self) -> &'static str {
        self.0.kind()
    }

    pub(super) fn emit(&self, writer: &mut Writer) {
        self.0.emit(writer);
    }

    /// Compares this profile with another one.
    ///
    /// # Errors
    /// Returns [`ProfileError::OtherKind`] if the other profile is for a different kind of device.
    pub fn compare(&self, other: &Body) -> Result<Comparison, ProfileError> {
        self.0.compare_with(other.0.as_ref()).ok_or_else(|| other.wrong_kind_error(self.kind()))
    }

    pub(super) fn single_values(&self) -> fn(&ChangedItem) -> Vec<ChangedItem> {
        self.0.single_values()
    }

    pub(super) fn keep_items(&mut self, items: &[ChangedItem]) {
        self.0.keep_items(items);
    }

    /// Returns what the user must do about a written item that cannot be restored from this backup.
    pub fn redo(&self, item: &ChangedItem) -> Option<Redo> {
        self.0.redo(item)
    }

    /// Returns the error that this profile is not for the kind of device `wanted`.
    pub fn wrong_kind_error(&self, wanted: &'static str) -> ProfileError {
        ProfileError::OtherKind { found: self.kind(), wanted }
    }

    /// Returns the profile as `P`, or `None` if it is for another kind of device.
    pub fn get<P: Profile>(&self) -> Option<&P> {
        let any: &dyn Any = self.0.as_ref();
        any.downcast_ref()
    }

    /// Returns the profile as mutable `P`, or `None` if it is for another kind of device.
    pub fn get_mut<P: Profile>(&mut self) -> Option<&mut P> {
        let any: &mut dyn Any = self.0.as_mut();
        any.downcast_mut()
    }

    /// Converts the profile to `P`.
    ///
    /// # Errors
    /// Returns [`ProfileError::OtherKind`] if the profile is for a different kind of device.
    pub fn into_profile<P: Profile>(self) -> Result<P, ProfileError> {
        let found = self.kind();
        let any: Box<dyn Any> = self.0;
        any.downcast().map(|profile| *profile).map_err(|_| ProfileError::OtherKind { found, wanted: P::KIND })
    }
}

impl Clone for Body {
    fn clone(&self) -> Self {
        Body(self.0.clone_boxed())
    }
}

impl fmt::Debug for Body {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

impl PartialEq for Body {
    fn eq(&self, other: &Self) -> bool {
        self.0.dyn_eq(other.0.as_ref())
    }
}

/// The readable profile formats. Messages list them in this order.
#[derive(Clone, Copy, Debug)]
pub struct ProfileFormats(&'static [&'static dyn ProfileFormat]);

impl ProfileFormats {
    /// Creates a list of formats.
    pub const fn new(formats: &'static [&'static dyn ProfileFormat]) -> Self {
        ProfileFormats(formats)
    }

    /// Returns the keywords for the kinds of devices.
    pub fn kinds(self) -> impl Iterator<Item = &'static str> {
        self.0.iter().map(|format| format.kind())
    }

    pub(super) fn parse(self, kind: String, entries: &mut Entries) -> Result<Body, ProfileError> {
        match self.0.iter().find(|format| format.kind() == kind) {
            Some(format) => format.parse(entries),
            None => Err(ProfileError::Device { found: kind, known: self.kinds().collect() }),
        }
    }
}
