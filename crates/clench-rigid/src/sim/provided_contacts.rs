//! Steps and forward passes with contacts that the caller gives.

use super::Sim;
use crate::Precision;
use clench_dynamics::check::check_contact;
use clench_dynamics::contact::Contact;
use clench_dynamics::error::SimError;
use clench_math::Mask;

impl<T: Precision> Sim<T> {
    /// Runs [`forward`](Self::forward) with these contacts instead of detected ones. A contact is included if it is
    /// `active` and `dist < includemargin`.
    ///
    /// # Errors
    /// Returns an error as [`step`](Self::step) does, or if a contact is invalid.
    pub fn forward_with_contacts(&mut self, contacts: &[Contact<T>]) -> Result<(), SimError> {
        self.with_contacts(contacts, Self::forward)
    }

    /// Runs [`step`](Self::step) with these contacts instead of detected ones, in every stage of the integrator.
    ///
    /// # Errors
    /// See [`forward_with_contacts`](Self::forward_with_contacts).
    pub fn step_with_contacts(&mut self, contacts: &[Contact<T>]) -> Result<(), SimError> {
        self.with_contacts(contacts, Self::step)
    }

    fn with_contacts(
        &mut self,
        contacts: &[Contact<T>],
        compute: impl FnOnce(&mut Self) -> Result<(), SimError>,
    ) -> Result<(), SimError> {
        for (index, contact) in contacts.iter().enumerate() {
            check_contact(&self.model, contact)
                .map_err(|reason| SimError::Contact { index, reason })?;
        }
        self.ws.contacts.clear();
        self.ws.contacts.extend(contacts.iter().map(Contact::splat));
        self.ws.collision.contacts_provided = true;
        self.ws.collision.overflow = Mask::splat(false);
        let result = compute(self);
        self.ws.collision.contacts_provided = false;
        result
    }
}
