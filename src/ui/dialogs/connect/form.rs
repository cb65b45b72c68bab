//! The connection form for one kind of device. Each device module implements a typed trait, which an adapter turns into
//! the object-safe trait used by the dialog.

use egui::Ui;

use crate::app::Action;
use crate::app::connect::form::FormModel;
use crate::app::connect::{ConnectAction as Connect, ConnectDialog as Dialog};
use crate::ui::Theme;

pub trait TypedConnectForm: 'static {
    type Form: FormModel;
    /// Selections in the form that are not part of the link.
    type Memory: Default;

    /// Draws the form. `more` states whether the rarely needed entries are expanded. The state is shared by all kinds.
    fn form_ui(
        ui: &mut Ui,
        theme: &Theme,
        dialog: &Dialog,
        form: &mut Self::Form,
        memory: (&mut Self::Memory, &mut bool),
        actions: &mut Vec<Action>,
    );
}

/// Object-safe connection form for one kind of device, including its selections.
pub trait ConnectForm {
    /// Draws the form. `more` states whether the rarely needed entries are expanded. The state is shared by all kinds.
    fn form_ui(&mut self, ui: &mut Ui, theme: &Theme, dialog: &Dialog, more: &mut bool, actions: &mut Vec<Action>);
}

pub(in crate::ui) fn new_form<F: TypedConnectForm>() -> Box<dyn ConnectForm> {
    Box::new(FormAdapter::<F>(F::Memory::default()))
}

struct FormAdapter<F: TypedConnectForm>(F::Memory);

impl<F: TypedConnectForm> ConnectForm for FormAdapter<F> {
    fn form_ui(&mut self, ui: &mut Ui, theme: &Theme, dialog: &Dialog, more: &mut bool, actions: &mut Vec<Action>) {
        let Some(own) = dialog.form_as::<F::Form>() else { return };
        let mut form = own.clone();
        F::form_ui(ui, theme, dialog, &mut form, (&mut self.0, more), actions);
        if form != *own {
            // The edit comes first, because the other actions depend on it.
            actions.insert(0, Action::Connect(Connect::edit_form(form)));
        }
    }
}
