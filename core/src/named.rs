//! Enums whose variants have a name, as in JSON and tables.

/// Defines an enum, the name of each variant, and the list of all variants unless it is left out.
macro_rules! named_enum {
    (
        $(#[$doc:meta])*
        pub enum $Enum:ident { $($(#[$entry_doc:meta])* $Entry:ident = $name:literal,)+ }
        $(#[$name_doc:meta])* fn name;
    ) => {
        $(#[$doc])*
        pub enum $Enum {
            $($(#[$entry_doc])* $Entry,)+
        }

        impl $Enum {
            $(#[$name_doc])*
            #[must_use]
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$Entry => $name,)+
                }
            }
        }
    };
    (
        $(#[$doc:meta])*
        pub enum $Enum:ident { $($(#[$entry_doc:meta])* $Entry:ident = $name:literal,)+ }
        $(#[$all_doc:meta])* const ALL;
        $(#[$name_doc:meta])* fn name;
    ) => {
        named_enum! {
            $(#[$doc])* pub enum $Enum { $($(#[$entry_doc])* $Entry = $name,)+ }
            $(#[$name_doc])* fn name;
        }

        impl $Enum {
            $(#[$all_doc])*
            pub const ALL: [Self; [$($name),+].len()] = [$(Self::$Entry),+];
        }
    };
}
pub(crate) use named_enum;
