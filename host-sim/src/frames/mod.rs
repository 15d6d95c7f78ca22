//! Captured frames and scene folders.
