//! clench
