//! A kind of device as the studio knows it before any device is open: its tab, links and profiles. Each kind implements
//! [`DeviceType`], and an adapter provides it to the studio as a [`DeviceKind`].

#![warn(missing_docs)]

use std::marker::PhantomData;
use std::path::Path;

use super::AnyDevice;
use super::model::DeviceModel;
use crate::app::Text;
use crate::app::comparison::ItemValues;
use crate::app::connect::form::{AnyForm, Finder, FormModel, FormModelAdapter};
use crate::app::payload::{Payload, PayloadKindError};
use crate::app::report::{ReportContent, ReportContext};
use crate::app::services::Services;
use crate::app::session::{Kind, ProfileFile, Session};
use crate::app::studio::SessionId;
use crate::app::tab::Tab;
use crate::link::LinkUrl;
use crate::profile::{Cause, Profile, ProfileDocument, ProfileFormat};
use crate::store::Store;
use crate::worker::OpenError;

/// The device or layout that a profile describes, as shown in lists of profiles. Each part may be empty.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ProfileSubject {
    /// Name that the user gave to the profile.
    pub name: String,
    /// Type of the device, with its maker if the profile states one.
    pub device_type: String,
    /// Serial number of the device.
    pub serial_number: String,
}

/// A kind of device. Each device folder implements it once.
pub trait DeviceType: DeviceModel + Sized {
    /// Entry in the list of device kinds.
    const KIND: &'static dyn DeviceKind = &DeviceKindAdapter::<Self>(PhantomData);

    /// Name of the bus, which is the same in every language.
    const BUS: &'static str;

    /// Profile type in which devices of this kind are saved.
    type Profile: Profile;

    /// Type of the form in the connection dialog.
    type Form: FormModel;

    /// Tables that are needed, besides the file, to read profiles of this kind.
    type Tables: Send + 'static;

    /// Checks whether a link can refer to a device of this kind. The link is not opened.
    ///
    /// # Errors
    /// Returns the reason why the link cannot refer to such a device.
    fn check_link(url: &LinkUrl) -> Result<(), OpenError>;

    /// Returns the parameters of a link that are secret. Their values are neither displayed nor stored.
    fn secret_parameters() -> Vec<&'static str>;

    /// Returns whether another master may be on the line to which a link refers. If so, the user is asked before
    /// anything is sent.
    fn may_have_other_master(_url: &LinkUrl) -> bool {
        false
    }

    /// Returns whether such a link usually refers to this kind of device. The link may be valid for other kinds as
    /// well.
    fn is_typical_link(_url: &LinkUrl) -> bool {
        true
    }

    /// Creates a device from an opened profile and its tables, or a device without data.
    fn create(
        session: Session<Self::Device>,
        profile: Option<(&Self::Profile, Self::Tables)>,
        services: &mut Services,
    ) -> Self;

    /// Creates a device for a link that is being opened.
    fn for_link(id: SessionId, url: LinkUrl, services: &mut Services) -> Self {
        Self::create(Session::for_link(id, url, services.world.kinds), None, services)
    }

    /// Reads the tables that profiles of this kind require. Runs on a task thread.
    fn load_tables(store: &Store) -> Self::Tables;

    /// Creates an offline device from a profile.
    fn from_file(
        id: SessionId,
        file: ProfileFile,
        document: ProfileDocument,
        tables: Self::Tables,
        services: &mut Services,
    ) -> Self {
        let session = Session::from_file(id, file, document.clone());
        let mut own = Self::create(session, document.body.get().map(|profile| (profile, tables)), services);
        own.load_draft(services);
        own
    }

    /// Returns the display name of an item in a profile or the logbook. `manual_name` is the name in the manual, if the
    /// item is an address. Returns `None` if no name is better than the item itself.
    fn item_name(_item: &str, _manual_name: Option<&str>) -> Option<Text> {
        None
    }

    /// Returns the heading under which a comparison lists an item, such as the drive or data field to which it belongs.
    fn item_group(_item: &str) -> Option<Text> {
        None
    }

    /// Returns a function that describes the values of a profile. See [`ItemValues`].
    fn item_values(_profile: &Self::Profile, _document: &ProfileDocument) -> ItemValues {
        Box::new(|_, _| None)
    }

    /// Returns the device or layout that a profile describes, for lists of profiles.
    fn profile_subject(_profile: &Self::Profile) -> ProfileSubject {
        ProfileSubject::default()
    }

    /// Returns the values of a profile and what they mean, for a report.
    ///
    /// # Errors
    /// Returns a message if a table of the user cannot be read.
    fn report(
        profile: &Self::Profile,
        document: &ProfileDocument,
        context: &ReportContext<'_>,
    ) -> Result<ReportContent, Text>;

    /// Returns the reason why a profile was rejected, or `None` if this kind of device does not know the cause.
    fn explain_rejection(_cause: &Cause) -> Option<Text> {
        None
    }

    /// Creates a profile without a file. Returns `None` if profiles of this kind can only be read from devices.
    ///
    /// `is_taken` returns whether a file name is in use.
    fn new_profile(_id: SessionId, _is_taken: &dyn Fn(&Path) -> bool, _services: &mut Services) -> Option<Self> {
        None
    }
}

/// A function that opens a profile in a session.
pub(crate) type OpenProfile =
    Box<dyn FnOnce(SessionId, ProfileFile, ProfileDocument, &mut Services) -> Box<AnyDevice> + Send>;

/// The object-safe interface of a kind of device, implemented for every [`DeviceType`].
pub trait DeviceKind: Sync {
    /// Returns the tab in which devices of this kind are shown.
    fn tab(&self) -> Tab;
    /// Returns the name of the bus, which is the same in every language.
    fn bus_name(&self) -> &'static str;
    /// Returns the keyword for this kind in profiles and on the command line.
    fn keyword(&self) -> &'static str;
    /// Returns the format of profiles of this kind.
    fn profile_format(&self) -> &'static dyn ProfileFormat;
    /// Checks whether a link can refer to a device of this kind.
    ///
    /// # Errors
    /// Returns the reason why the link cannot refer to such a device.
    fn check_link(&self, url: &LinkUrl) -> Result<(), OpenError>;
    /// Returns the parameters of a link that are secret. Their values are neither displayed nor stored.
    fn secret_parameters(&self) -> Vec<&'static str>;
    /// Returns the link to the virtual device of this kind.
    fn virtual_link(&self) -> LinkUrl;
    /// Returns whether another master may be on the line to which a link refers.
    fn may_have_other_master(&self, url: &LinkUrl) -> bool;
    /// Returns whether such a link usually refers to this kind of device.
    fn is_typical_link(&self, url: &LinkUrl) -> bool;
    /// Returns the reason why a profile was rejected, or `None` if this kind of device does not know the cause.
    fn explain_rejection(&self, cause: &Cause) -> Option<Text>;
    /// Returns the display name of an item in a profile or the logbook, or `None` if no name is better than the item
    /// itself.
    fn item_name(&self, item: &str, manual_name: Option<&str>) -> Option<Text>;
    /// Returns the heading under which a comparison lists an item.
    fn item_group(&self, item: &str) -> Option<Text>;
    /// Returns a function that describes the values of a profile. For a profile of another kind of device, it describes
    /// nothing.
    fn item_values(&self, document: &ProfileDocument) -> ItemValues;
    /// Returns the device or layout that a profile describes. It is empty for a profile of another kind of device.
    fn profile_subject(&self, document: &ProfileDocument) -> ProfileSubject;
    /// Returns the values of a profile and what they mean, for a report. Returns `None` for a profile of another kind
    /// of device.
    fn report(&self, document: &ProfileDocument, context: &ReportContext<'_>) -> Option<Result<ReportContent, Text>>;
    /// Returns the form for the connection dialog, filled in from a link.
    fn create_form(&self, link: Option<LinkUrl>) -> Box<dyn AnyForm>;
    #[doc(hidden)]
    fn handle_finder_result(
        &self,
        form: Option<&mut dyn AnyForm>,
        done: Payload,
        services: &mut Services,
    ) -> Result<(), PayloadKindError>;
    #[doc(hidden)]
    fn for_link(&self, id: SessionId, url: LinkUrl, services: &mut Services) -> Box<AnyDevice>;
    #[doc(hidden)]
    fn read_tables(&self, store: &Store) -> OpenProfile;
    #[doc(hidden)]
    fn new_profile(
        &self,
        id: SessionId,
        is_taken: &dyn Fn(&Path) -> bool,
        services: &mut Services,
    ) -> Option<Box<AnyDevice>>;
}

/// Adapter from [`DeviceType`] to [`DeviceKind`].
struct DeviceKindAdapter<M>(PhantomData<fn() -> M>);

impl<M: DeviceType> DeviceKind for DeviceKindAdapter<M> {
    fn tab(&self) -> Tab {
        M::TAB
    }

    fn bus_name(&self) -> &'static str {
        M::BUS
    }

    fn keyword(&self) -> &'static str {
        <M::Device as Kind>::KIND
    }

    fn profile_format(&self) -> &'static dyn ProfileFormat {
        M::Profile::FORMAT
    }

    fn check_link(&self, url: &LinkUrl) -> Result<(), OpenError> {
        M::check_link(url)
    }

    fn explain_rejection(&self, cause: &Cause) -> Option<Text> {
        M::explain_rejection(cause)
    }

    fn item_name(&self, item: &str, manual_name: Option<&str>) -> Option<Text> {
        M::item_name(item, manual_name)
    }

    fn item_group(&self, item: &str) -> Option<Text> {
        M::item_group(item)
    }

    fn item_values(&self, document: &ProfileDocument) -> ItemValues {
        match document.body.get() {
            Some(profile) => M::item_values(profile, document),
            None => Box::new(|_, _| None),
        }
    }

    fn profile_subject(&self, document: &ProfileDocument) -> ProfileSubject {
        document.body.get().map(M::profile_subject).unwrap_or_default()
    }

    fn report(&self, document: &ProfileDocument, context: &ReportContext<'_>) -> Option<Result<ReportContent, Text>> {
        document.body.get().map(|profile| M::report(profile, document, context))
    }

    fn secret_parameters(&self) -> Vec<&'static str> {
        M::secret_parameters()
    }

    fn virtual_link(&self) -> LinkUrl {
        M::Form::default_link()
    }

    fn may_have_other_master(&self, url: &LinkUrl) -> bool {
        M::may_have_other_master(url)
    }

    fn is_typical_link(&self, url: &LinkUrl) -> bool {
        M::is_typical_link(url)
    }

    fn create_form(&self, link: Option<LinkUrl>) -> Box<dyn AnyForm> {
        Box::new(FormModelAdapter::<M::Form>::new(&link.unwrap_or_else(M::Form::default_link)))
    }

    fn handle_finder_result(
        &self,
        form: Option<&mut dyn AnyForm>,
        done: Payload,
        services: &mut Services,
    ) -> Result<(), PayloadKindError> {
        let finder = form.and_then(|form| form.finder_mut().downcast_mut());
        <M::Form as FormModel>::Finder::handle_result(finder, done.open()?, services);
        Ok(())
    }

    fn for_link(&self, id: SessionId, url: LinkUrl, services: &mut Services) -> Box<AnyDevice> {
        Box::new(M::for_link(id, url, services))
    }

    fn read_tables(&self, store: &Store) -> OpenProfile {
        let tables = M::load_tables(store);
        Box::new(|id, file, document, services| Box::new(M::from_file(id, file, document, tables, services)))
    }

    fn new_profile(
        &self,
        id: SessionId,
        is_taken: &dyn Fn(&Path) -> bool,
        services: &mut Services,
    ) -> Option<Box<AnyDevice>> {
        M::new_profile(id, is_taken, services).map(|device| Box::new(device) as Box<AnyDevice>)
    }
}
