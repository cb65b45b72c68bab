//! Shows which devices are connected to which computer. If a device appears to be connected to several computers, each
//! of them is warned about the others. This does not lock the device.

use std::time::Duration;

use super::super::entry::{DeviceKey, Origin};
use super::LogbookServer;
use super::client::Client;
use super::error::ServerErrorKind;

/// Time after which a hold expires if the computer does not renew it.
const HOLD_VALIDITY: Duration = Duration::from_secs(30);

/// Another program that is connected to the same device.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OtherHolder {
    pub device: DeviceKey,
    pub bench: String,
    pub user: Option<String>,
}

/// A device that is connected to this program, as announced to the server. Dropping the value withdraws the
/// announcement.
#[derive(Debug)]
pub struct DeviceHold {
    server: LogbookServer,
    device: DeviceKey,
}

impl LogbookServer {
    /// Announces in the next transfer that a device is connected to this program. Virtual devices and devices without a
    /// serial number are not announced, because they cannot be told apart.
    pub fn hold(&self, device: &DeviceKey) -> Option<DeviceHold> {
        if device.is_virtual || device.serial_number.is_empty() {
            return None;
        }
        self.state().held.push(device.clone());
        Some(DeviceHold { server: self.clone(), device: device.clone() })
    }
}

impl Drop for DeviceHold {
    fn drop(&mut self) {
        let held = &mut self.server.state().held;
        if let Some(at) = held.iter().position(|device| *device == self.device) {
            held.swap_remove(at);
        }
    }
}

/// Renews a program's holds and returns the other holders of the same devices.
pub(super) fn renew(
    client: &mut Client,
    program: &str,
    held: &[DeviceKey],
) -> Result<Vec<OtherHolder>, ServerErrorKind> {
    let texts = |of: fn(&DeviceKey) -> &String| held.iter().map(|device| of(device).clone()).collect::<Vec<_>>();
    let kinds = texts(|device| &device.kind);
    let (types, numbers) = (texts(|device| &device.device_type), texts(|device| &device.serial_number));
    let Origin { bench, user, .. } = Origin::of_this_process();
    let valid = HOLD_VALIDITY.as_secs_f64();
    client.run(async |postgres| {
        let transaction = postgres.transaction().await?;
        transaction.execute("DELETE FROM hold WHERE program = $1 OR until < now()", &[&program]).await?;
        let sql = r#"INSERT INTO hold (program, kind, device_type, serial_number, bench, "user", until)
            SELECT DISTINCT $1, kind, device_type, serial_number, $5, $6, now() + make_interval(secs => $7)
            FROM unnest($2::text[], $3::text[], $4::text[]) AS own (kind, device_type, serial_number)"#;
        transaction.execute(sql, &[&program, &kinds, &types, &numbers, &bench, &user, &valid]).await?;
        let sql = r#"SELECT DISTINCT kind, device_type, serial_number, bench, "user" FROM hold
            JOIN unnest($2::text[], $3::text[], $4::text[]) AS own (kind, device_type, serial_number)
                USING (kind, device_type, serial_number)
            WHERE program <> $1 ORDER BY kind, device_type, serial_number, bench"#;
        let mut others = Vec::new();
        for row in transaction.query(sql, &[&program, &kinds, &types, &numbers]).await? {
            let [kind, device_type, serial_number]: [String; 3] = [row.try_get(0)?, row.try_get(1)?, row.try_get(2)?];
            let device = DeviceKey { kind, device_type, serial_number, is_virtual: false };
            others.push(OtherHolder { device, bench: row.try_get(3)?, user: row.try_get(4)? });
        }
        transaction.commit().await?;
        Ok(others)
    })
}
