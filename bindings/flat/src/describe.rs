//! Description of the API, from which the C header and the struct layouts for other languages are generated.

/// A constant.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Constant {
    pub(crate) name: &'static str,
    pub(crate) value: i64,
    pub(crate) docs: &'static [&'static str],
}

/// An alias of an integer type.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Alias {
    pub(crate) name: &'static str,
    pub(crate) of: &'static str,
    pub(crate) docs: &'static [&'static str],
}

/// A field of a struct.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Field {
    pub(crate) name: &'static str,
    /// Type of the field, or of its items if it is an array.
    pub(crate) kind: &'static str,
    /// Number of items of an array.
    pub(crate) count: Option<usize>,
    pub(crate) offset: usize,
    pub(crate) docs: &'static [&'static str],
}

/// A struct.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Struct {
    pub(crate) name: &'static str,
    pub(crate) bytes: usize,
    /// Fields in order, without gaps.
    pub(crate) fields: &'static [Field],
    pub(crate) docs: &'static [&'static str],
}

/// A parameter of a function.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Parameter {
    pub(crate) name: &'static str,
    /// Type in C, in three parts: the text before the base type, the base type and the text after it, such as `const `,
    /// `ls2d_vec2` and ` *`.
    pub(crate) kind: [&'static str; 3],
}

/// A function.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Function {
    pub(crate) name: &'static str,
    pub(crate) parameters: &'static [Parameter],
    pub(crate) returns: &'static str,
    pub(crate) docs: &'static [&'static str],
}

/// A Rust type of parameters, fields or results, and its description in C.
pub(crate) trait CType {
    /// Type of the value, or of the items that it points to.
    const BASE: &'static str;
    /// Text before and after `BASE`.
    const AROUND: [&'static str; 2] = ["", ""];
    /// Number of items of an array.
    const COUNT: Option<usize> = None;
}

macro_rules! c_types {
    ($($type:ty => $name:literal;)+) => {
        $(impl CType for $type {
            const BASE: &'static str = $name;
        })+
    };
}

c_types! {
    u8 => "uint8_t";
    u32 => "uint32_t";
    i32 => "int32_t";
    u64 => "uint64_t";
    i64 => "int64_t";
    usize => "size_t";
}

impl<T: CType> CType for crate::border::In<'_, T> {
    const BASE: &'static str = T::BASE;
    const AROUND: [&'static str; 2] = ["const ", " *"];
}

impl<T: CType> CType for crate::border::Out<'_, T> {
    const BASE: &'static str = T::BASE;
    const AROUND: [&'static str; 2] = ["", " *"];
}

impl<T: CType, const N: usize> CType for [T; N] {
    const BASE: &'static str = T::BASE;
    const COUNT: Option<usize> = Some(N);
}

pub(crate) const fn parameter<T: CType>(name: &'static str) -> Parameter {
    Parameter { name, kind: [T::AROUND[0], T::BASE, T::AROUND[1]] }
}

/// Defines aliases of integers as distinct Rust types, and their descriptions.
macro_rules! aliases {
    ($($(#[doc = $doc:literal])+ $name:ident($of:ty) = $c:literal;)+) => {
        $(
            $(#[doc = $doc])+
            #[repr(transparent)]
            #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
            pub struct $name(pub $of);

            // SAFETY: a single integer.
            unsafe impl $crate::border::Plain for $name {}

            impl $crate::describe::CType for $name {
                const BASE: &'static str = $c;
            }
        )+

        pub(crate) const ALIASES: &[$crate::describe::Alias] = &[$($crate::describe::Alias {
            name: $c,
            of: <$of as $crate::describe::CType>::BASE,
            docs: &[$($doc),+],
        }),+];
    };
}

macro_rules! constants {
    ($($(#[doc = $doc:literal])+ $name:ident = $value:literal, $c:literal;)+) => {
        $(
            $(#[doc = $doc])+
            pub const $name: u32 = $value;
        )+

        pub(crate) const CONSTANTS: &[$crate::describe::Constant] =
            &[$($crate::describe::Constant { name: $c, value: $value, docs: &[$($doc),+] }),+];
    };
}

/// Defines structs that C and Rust share, and their descriptions. A struct with padding does not compile.
macro_rules! records {
    ($($(#[doc = $doc:literal])+ struct $name:ident = $c:literal {
        $($(#[doc = $field_doc:literal])+ $field:ident: $type:ty,)+
    })+) => {
        $(
            $(#[doc = $doc])+
            #[repr(C)]
            #[derive(Clone, Copy, Debug, PartialEq, Eq)]
            pub struct $name {
                $($(#[doc = $field_doc])+ pub $field: $type,)+
            }

            const _: () = assert!(size_of::<$name>() == 0 $(+ size_of::<$type>())+, "a struct has gaps");

            // SAFETY: its fields are plain, and there is no padding between them.
            unsafe impl $crate::border::Plain for $name where $($type: $crate::border::Plain),+ {}

            impl $crate::describe::CType for $name {
                const BASE: &'static str = $c;
            }
        )+

        pub(crate) const STRUCTS: &[$crate::describe::Struct] = &[$($crate::describe::Struct {
            name: $c,
            bytes: size_of::<$name>(),
            fields: &[$($crate::describe::Field {
                name: stringify!($field),
                kind: <$type as $crate::describe::CType>::BASE,
                count: <$type as $crate::describe::CType>::COUNT,
                offset: std::mem::offset_of!($name, $field),
                docs: &[$($field_doc),+],
            }),+],
            docs: &[$($doc),+],
        }),+];
    };
}

/// Defines functions. If no result type is given, the body returns an `Outcome`, which the function converts to a
/// status code. Otherwise the body returns the function's value.
macro_rules! api {
    ($($(#[doc = $doc:literal])+ fn $name:ident($($argument:ident: $type:ty),* $(,)?) $(-> $value:ty)? $body:block)+) => {
        $($crate::describe::api!(@define [$($doc)+] $name [$($argument: $type),*] [$($value)?] $body);)+

        pub(crate) const FUNCTIONS: &[$crate::describe::Function] = &[$($crate::describe::Function {
            name: stringify!($name),
            parameters: &[$($crate::describe::parameter::<$type>(stringify!($argument))),*],
            returns: $crate::describe::api!(@returns [$($value)?]),
            docs: &[$($doc),+],
        }),+];

        /// For each function, a closure that draws the arguments from the input of a `Caller` and calls the function.
        #[cfg(any(test, feature = "fuzzing"))]
        pub(crate) const DRAWN: &[$crate::fuzzing::DrawnCall] = &[$(|caller| {
            $(let $argument = <$type as $crate::fuzzing::Drawn>::draw(caller, stringify!($argument));)*
            $crate::fuzzing::Returned::check($name($($argument),*), caller, stringify!($name));
        }),+];
    };
    (@define [$($doc:literal)+] $name:ident [$($argument:ident: $type:ty),*] [] $body:block) => {
        $(#[doc = $doc])+
        #[unsafe(no_mangle)]
        pub extern "C" fn $name($($argument: $type),*) -> i32 {
            $crate::border::guard(move || $body)
        }
    };
    (@define [$($doc:literal)+] $name:ident [$($argument:ident: $type:ty),*] [$value:ty] $body:block) => {
        $(#[doc = $doc])+
        #[unsafe(no_mangle)]
        pub extern "C" fn $name($($argument: $type),*) -> $value $body
    };
    (@returns []) => { "ls2d_status" };
    (@returns [$value:ty]) => { <$value as $crate::describe::CType>::BASE };
}

pub(crate) use {aliases, api, constants, records};
