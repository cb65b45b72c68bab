//! Blocking tasks, such as file access, opening links, and system dialogs. Each task runs on a thread and delivers its
//! result as an action.

use std::sync::Arc;
use std::thread;

use crossbeam_channel::{Receiver, Sender, unbounded};

use super::Action;

/// A callback that wakes the window when there are new events.
pub type WakeCallback = Arc<dyn Fn() + Send + Sync>;

/// A runner for tasks on threads. The result of each task is delivered as an action.
pub struct TaskRunner {
    sender: Sender<Action>,
    receiver: Receiver<Action>,
    wake: WakeCallback,
}

/// A mailbox that accepts actions for the application state from any thread.
#[derive(Clone)]
pub struct ActionMailbox {
    sender: Sender<Action>,
    wake: WakeCallback,
}

impl TaskRunner {
    pub(crate) fn new(wake: WakeCallback) -> Self {
        // The channel needs no limit, because each thread sends only once and is started by an action of the user.
        let (sender, receiver) = unbounded();
        TaskRunner { sender, receiver, wake }
    }

    /// Runs a task on a thread and delivers its result as an action.
    pub(crate) fn run(&self, name: &str, task: impl FnOnce() -> Action + Send + 'static) {
        let mailbox = self.mailbox();
        let spawned = thread::Builder::new().name(name.to_owned()).spawn(move || mailbox.send(task()));
        if let Err(error) = spawned {
            self.mailbox().send(Action::NoThread(error.to_string()));
        }
    }

    pub fn mailbox(&self) -> ActionMailbox {
        ActionMailbox { sender: self.sender.clone(), wake: self.wake.clone() }
    }

    /// Returns the callback that sessions use to wake the window.
    pub(crate) fn wake_callback(&self) -> WakeCallback {
        self.wake.clone()
    }

    pub(crate) fn next(&self) -> Option<Action> {
        self.receiver.try_recv().ok()
    }
}

impl ActionMailbox {
    pub fn send(&self, action: Action) {
        // If the application has ended, the action is no longer needed.
        let _ = self.sender.send(action);
        self.wake_window();
    }

    pub(super) fn wake_window(&self) {
        (self.wake)();
    }
}
