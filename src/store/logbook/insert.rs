//! Inserts events into the logbook.

use std::path::Path;

use jiff::Timestamp;
use rusqlite::{Connection, TransactionBehavior, named_params};

use super::entry::{DeviceKey, EntryId, EntryKind, EntryUid, Event, Origin};
use super::{AssetName, query};
use crate::profile::ChangedItem;

/// Values that only some kinds of event have.
#[derive(Clone, Copy, Default)]
pub(super) struct Further<'e> {
    pub planned_cycles: u64,
    /// Asset to which the device is assigned from this event on.
    pub asset: Option<&'e AssetName>,
    /// The entry that this event undoes.
    pub undoes: Option<&'e EntryUid>,
}

pub(super) fn event(
    database: &Connection,
    origin: &Origin,
    at: Timestamp,
    device: &DeviceKey,
    event: &Event,
    further: Further<'_>,
) -> rusqlite::Result<EntryId> {
    let Origin { bench, user, version } = origin;
    let sql = "INSERT INTO event (uid, at, what, kind, device_type, serial_number, is_virtual, description, items,
                                  planned_cycles, backup, bench, user, version, asset, undoes)
               VALUES (lower(hex(randomblob(16))), :at, :what, :kind, :device_type, :serial_number, :is_virtual,
                       :description, :items, :planned_cycles, :backup, :bench, :user, :version, :asset,
                       :undoes)";
    let parameters = named_params! {
        ":at": at.to_string(),
        ":what": event.kind.keyword(),
        ":kind": device.kind,
        ":device_type": device.device_type,
        ":serial_number": device.serial_number,
        ":is_virtual": device.is_virtual,
        ":description": event.description,
        ":items": query::items_json(&event.items),
        ":planned_cycles": saturating_cycle_count(further.planned_cycles),
        ":backup": event.backup.as_deref().map(Path::to_string_lossy),
        ":bench": bench,
        ":user": user,
        ":version": version,
        ":asset": further.asset.map(AssetName::as_str),
        ":undoes": further.undoes.map(|own| &own.0),
    };
    database.execute(sql, parameters)?;
    Ok(EntryId(database.last_insert_rowid()))
}

/// Adds an assignment, unless the device is already assigned to this asset.
pub(super) fn assignment(
    database: &mut Connection,
    origin: &Origin,
    at: Timestamp,
    device: &DeviceKey,
    asset: &AssetName,
) -> rusqlite::Result<()> {
    // Another window may assign the device at the same time.
    let transaction = database.transaction_with_behavior(TransactionBehavior::Immediate)?;
    let present = query::current_asset(&transaction, device)?;
    if present.as_deref() == Some(asset.as_str()) {
        return Ok(());
    }
    let item = ChangedItem::new("asset", present, Some(asset.to_string()));
    let new = Event { items: vec![item.clone()], ..Event::new(EntryKind::Assigned, item.to_string()) };
    event(&transaction, origin, at, device, &new, Further { asset: Some(asset), ..Further::default() })?;
    transaction.commit()
}

/// Limits the number of write cycles of an entry to 32 bits, so that the sum of all entries cannot overflow. No EEPROM
/// survives a thousandth of this number.
pub(super) fn saturating_cycle_count(cycles: u64) -> u32 {
    u32::try_from(cycles).unwrap_or(u32::MAX)
}
