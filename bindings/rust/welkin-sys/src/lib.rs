//! Bindings of Welkin's C interface, `welkin/welkin.h`, whose comments state the contract of each function.
//!
//! Functions about files (`..._file`, `..._save`, `..._load`, `welkin_write_...`) link only with the feature `files`.
#![allow(non_camel_case_types)]

include!("bindings.rs");
