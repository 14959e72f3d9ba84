//! What the tables of a scene's file may say, as data: from these the reader, the schema and the
//! vocabulary are made.

/// A table of the vocabulary.
#[derive(Debug)]
pub(crate) struct Table {
    /// Its name in the schema.
    pub(crate) name: &'static str,
    /// What it says, a sentence a line.
    pub(crate) says: &'static [&'static str],
    pub(crate) keys: &'static [Key],
}

/// A key of a table.
#[derive(Debug)]
pub(crate) struct Key {
    pub(crate) name: &'static str,
    pub(crate) says: &'static [&'static str],
    pub(crate) required: bool,
    pub(crate) kind: Kind,
}

/// What a key takes.
#[derive(Debug)]
pub(crate) enum Kind {
    /// Any number.
    Number,
    /// A number above zero.
    Positive,
    /// A number, zero or above.
    NotNegative,
    /// A number from 0 to 1.
    Share,
    /// A number above 0 and below 1.
    Tolerance,
    /// 1, 2 or 3.
    Dimension,
    /// A whole number, at least this.
    Count(u64),
    /// True or false.
    Flag,
    /// A text.
    Text,
    /// A name.
    Name,
    /// Two names.
    Pair,
    /// As many numbers as the scene has dimensions.
    Vector,
    /// A number in the plane, a vector in space.
    Turn,
    /// A number, or a table that tells one in time.
    Strength,
    /// Numbers by name.
    Numbers,
    /// Places by name.
    Marks,
    /// One of these words.
    OneOf(&'static [&'static str]),
    /// A word, or a word with names.
    Observable,
    /// A table.
    Table(&'static Table),
    /// Several of these.
    List(&'static Kind),
}

/// Whether a key of this type must be there.
pub(crate) trait Presence {
    const REQUIRED: bool;
}

impl<T> Presence for Option<T> {
    const REQUIRED: bool = false;
}

impl<T> Presence for Vec<T> {
    const REQUIRED: bool = false;
}

impl Presence for crate::text::turn::Turn {
    const REQUIRED: bool = true;
}

impl<T> Presence for toml::Spanned<T> {
    const REQUIRED: bool = true;
}

/// Tables as types that are read from a text, each with what it says as data.
///
/// A key is written `name: Type = Kind`, or `field as "name": Type = Kind`.
macro_rules! table {
    ($(
        $(#[doc = $says:literal])*
        pub(crate) struct $name:ident $([$extra:ident])? = $expecting:literal {
            $(
                $(#[doc = $about:literal])*
                $(#[serde($($serde:tt)*)])?
                $key:ident $(as $called:literal)?: $kind:ty = $takes:expr,
            )*
        }
    )*) => {$(
        $(#[doc = $says])*
        #[derive(Clone, Debug, $($extra,)? serde::Deserialize)]
        #[serde(remote = "Self", deny_unknown_fields)]
        pub(crate) struct $name {
            $(
                $(#[doc = $about])*
                $(#[serde(rename = $called)])?
                $(#[serde($($serde)*)])?
                pub(crate) $key: $kind,
            )*
        }

        impl<'de> serde::Deserialize<'de> for $name {
            fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                struct Keys;
                impl<'de> serde::de::Visitor<'de> for Keys {
                    type Value = $name;

                    fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                        f.write_str($expecting)
                    }

                    // A list of values without their keys is no table.
                    fn visit_map<A: serde::de::MapAccess<'de>>(
                        self,
                        map: A,
                    ) -> Result<$name, A::Error> {
                        $name::deserialize(serde::de::value::MapAccessDeserializer::new(map))
                    }
                }
                deserializer.deserialize_map(Keys)
            }
        }

        impl $name {
            /// The table as data.
            pub(crate) const TABLE: $crate::words::table::Table = $crate::words::table::Table {
                name: stringify!($name),
                says: &[$($says),*],
                keys: &[$(
                    $crate::words::table::Key {
                        name: [$($called,)? stringify!($key)][0],
                        says: &[$($about),*],
                        required: <$kind as $crate::words::table::Presence>::REQUIRED,
                        kind: $takes,
                    },
                )*],
            };
        }
    )*};
}
pub(crate) use table;
