//! Reads a type from nothing, and writes down what it asks for.

use crate::form::{Asked, AskedField, Form, Kind};
use serde::de::value::StrDeserializer;
use serde::de::{
    DeserializeSeed, Deserializer, EnumAccess, Error as _, IntoDeserializer, MapAccess, SeqAccess,
    VariantAccess, Visitor,
};
use std::fmt::{self, Display, Formatter};

/// A reader of nothing at one place.
pub(crate) struct Asking<'a> {
    pub asked: &'a mut Asked,
}

/// Why a reading ended.
#[derive(Debug)]
pub(crate) enum Ended {
    /// A field has to be given.
    Missing(&'static str),
    /// For another reason, mostly what stands in for a value.
    Otherwise,
}

impl Display for Ended {
    fn fmt(&self, formatter: &mut Formatter) -> fmt::Result {
        match self {
            Self::Missing(field) => write!(formatter, "`{field}` is missing"),
            Self::Otherwise => formatter.write_str("read from nothing"),
        }
    }
}

impl std::error::Error for Ended {}

impl serde::de::Error for Ended {
    fn custom<T: Display>(_: T) -> Self {
        Self::Otherwise
    }

    fn missing_field(field: &'static str) -> Self {
        Self::Missing(field)
    }
}

macro_rules! plain {
    ($($method:ident $form:ident $visit:ident $value:expr,)*) => {
        $(fn $method<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Ended> {
            self.plain(Form::$form);
            visitor.$visit($value)
        })*
    };
}

impl Asking<'_> {
    fn plain(self, form: Form) {
        self.asked.kind = Kind::Plain(form);
        self.asked.done = true;
    }
}

impl<'de> Deserializer<'de> for Asking<'_> {
    type Error = Ended;

    plain! {
        deserialize_any Any visit_f64 1.0,
        deserialize_ignored_any Any visit_f64 1.0,
        deserialize_bool Flag visit_bool true,
        deserialize_i8 Whole visit_i8 1,
        deserialize_i16 Whole visit_i16 1,
        deserialize_i32 Whole visit_i32 1,
        deserialize_i64 Whole visit_i64 1,
        deserialize_u8 Whole visit_u8 1,
        deserialize_u16 Whole visit_u16 1,
        deserialize_u32 Whole visit_u32 1,
        deserialize_u64 Whole visit_u64 1,
        deserialize_f32 Number visit_f32 1.0,
        deserialize_f64 Number visit_f64 1.0,
        deserialize_char Text visit_char 'x',
        deserialize_str Text visit_str "x",
        deserialize_string Text visit_str "x",
        deserialize_identifier Text visit_str "x",
        deserialize_bytes Any visit_bytes b"x",
        deserialize_byte_buf Any visit_bytes b"x",
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Ended> {
        self.asked.optional = true;
        visitor.visit_some(self)
    }

    fn deserialize_unit<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Ended> {
        self.plain(Form::Fields(Vec::new()));
        visitor.visit_unit()
    }

    fn deserialize_unit_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        visitor: V,
    ) -> Result<V::Value, Ended> {
        self.deserialize_unit(visitor)
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        visitor: V,
    ) -> Result<V::Value, Ended> {
        visitor.visit_newtype_struct(self)
    }

    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Ended> {
        if !matches!(self.asked.kind, Kind::List(_)) {
            self.asked.kind = Kind::List(Box::default());
        }
        let Kind::List(inner) = &mut self.asked.kind else { return Err(Ended::Otherwise) };
        let value = visitor.visit_seq(Once(Some(&mut **inner)));
        self.asked.done = inner.done;
        value
    }

    fn deserialize_tuple<V: Visitor<'de>>(self, length: usize, visitor: V) -> Result<V::Value, Ended> {
        if !matches!(self.asked.kind, Kind::Tuple(_)) {
            self.asked.kind = Kind::Tuple((0..length).map(|_| Asked::default()).collect());
        }
        let Kind::Tuple(inner) = &mut self.asked.kind else { return Err(Ended::Otherwise) };
        let value = visitor.visit_seq(Each(inner.iter_mut()));
        self.asked.done = inner.iter().all(|one| one.done);
        value
    }

    fn deserialize_tuple_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        length: usize,
        visitor: V,
    ) -> Result<V::Value, Ended> {
        self.deserialize_tuple(length, visitor)
    }

    fn deserialize_map<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Ended> {
        if !matches!(self.asked.kind, Kind::Map(_)) {
            self.asked.kind = Kind::Map(Box::default());
        }
        let Kind::Map(inner) = &mut self.asked.kind else { return Err(Ended::Otherwise) };
        let value = visitor.visit_map(Entries { left: vec![("x", &mut **inner)], value: None });
        self.asked.done = inner.done;
        value
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        names: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Ended> {
        if !matches!(self.asked.kind, Kind::Fields(_)) {
            let field = |name: &&'static str| AskedField { name, asked: Asked::default(), required: false };
            self.asked.kind = Kind::Fields(names.iter().map(field).collect());
        }
        let Kind::Fields(fields) = &mut self.asked.kind else { return Err(Ended::Otherwise) };
        // First each field by itself, until it told all; what else lacks then is of no interest.
        if let Some(field) = fields.iter_mut().find(|field| !field.asked.done) {
            let left = vec![(field.name, &mut field.asked)];
            let value = visitor.visit_map(Entries { left, value: None });
            // One that was never looked at would be tried for ever.
            field.asked.done |= matches!(field.asked.kind, Kind::Unknown);
            return value;
        }
        // Then only what has to be given, and what lacks has to be given as well.
        let left: Vec<(&'static str, &mut Asked)> = fields
            .iter_mut()
            .filter(|field| field.required)
            .map(|field| (field.name, &mut field.asked))
            .collect();
        let value = visitor.visit_map(Entries { left, value: None });
        let lacking = match &value {
            Err(Ended::Missing(name)) => {
                fields.iter_mut().find(|field| field.name == *name && !field.required)
            }
            _ => None,
        };
        match lacking {
            Some(field) => field.required = true,
            None => self.asked.done = true,
        }
        value
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _: &'static str,
        names: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Ended> {
        if !matches!(self.asked.kind, Kind::Choice(_)) {
            self.asked.kind = Kind::Choice(names.iter().map(|name| (*name, None)).collect());
        }
        let Kind::Choice(variants) = &mut self.asked.kind else { return Err(Ended::Otherwise) };
        let open = variants.iter().position(|(_, inner)| inner.as_ref().is_none_or(|inner| !inner.done));
        let index = open.unwrap_or(0);
        let Some((name, inner)) = variants.get_mut(index) else {
            self.asked.done = true;
            return Err(Ended::custom("an enum without variants"));
        };
        let value = visitor.visit_enum(Variant { name, asked: inner.get_or_insert_default() });
        self.asked.done = variants.iter().all(|(_, inner)| inner.as_ref().is_some_and(|inner| inner.done));
        value
    }
}

/// A list of one.
struct Once<'a>(Option<&'a mut Asked>);

impl<'de> SeqAccess<'de> for Once<'_> {
    type Error = Ended;

    fn next_element_seed<T: DeserializeSeed<'de>>(&mut self, seed: T) -> Result<Option<T::Value>, Ended> {
        self.0.take().map(|asked| seed.deserialize(Asking { asked })).transpose()
    }
}

/// The elements of a tuple.
struct Each<'a>(std::slice::IterMut<'a, Asked>);

impl<'de> SeqAccess<'de> for Each<'_> {
    type Error = Ended;

    fn next_element_seed<T: DeserializeSeed<'de>>(&mut self, seed: T) -> Result<Option<T::Value>, Ended> {
        self.0.next().map(|asked| seed.deserialize(Asking { asked })).transpose()
    }
}

/// Entries of a map or fields of a struct.
struct Entries<'a> {
    left: Vec<(&'static str, &'a mut Asked)>,
    value: Option<&'a mut Asked>,
}

impl<'de> MapAccess<'de> for Entries<'_> {
    type Error = Ended;

    fn next_key_seed<K: DeserializeSeed<'de>>(&mut self, seed: K) -> Result<Option<K::Value>, Ended> {
        if self.left.is_empty() {
            return Ok(None);
        }
        let (name, asked) = self.left.remove(0);
        self.value = Some(asked);
        let key: StrDeserializer<Ended> = name.into_deserializer();
        seed.deserialize(key).map(Some)
    }

    fn next_value_seed<V: DeserializeSeed<'de>>(&mut self, seed: V) -> Result<V::Value, Ended> {
        let Some(asked) = self.value.take() else { return Err(Ended::Otherwise) };
        seed.deserialize(Asking { asked })
    }
}

/// One variant of an enum.
struct Variant<'a> {
    name: &'static str,
    asked: &'a mut Asked,
}

impl<'de> EnumAccess<'de> for Variant<'_> {
    type Error = Ended;
    type Variant = Self;

    fn variant_seed<V: DeserializeSeed<'de>>(self, seed: V) -> Result<(V::Value, Self), Ended> {
        let name: StrDeserializer<Ended> = self.name.into_deserializer();
        match seed.deserialize(name) {
            Ok(value) => Ok((value, self)),
            Err(error) => {
                self.asked.done = true;
                Err(error)
            }
        }
    }
}

impl<'de> VariantAccess<'de> for Variant<'_> {
    type Error = Ended;

    fn unit_variant(self) -> Result<(), Ended> {
        self.asked.kind = Kind::Tuple(Vec::new());
        self.asked.done = true;
        Ok(())
    }

    fn newtype_variant_seed<T: DeserializeSeed<'de>>(self, seed: T) -> Result<T::Value, Ended> {
        seed.deserialize(Asking { asked: self.asked })
    }

    fn tuple_variant<V: Visitor<'de>>(self, length: usize, visitor: V) -> Result<V::Value, Ended> {
        Asking { asked: self.asked }.deserialize_tuple(length, visitor)
    }

    fn struct_variant<V: Visitor<'de>>(
        self,
        names: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Ended> {
        Asking { asked: self.asked }.deserialize_struct("", names, visitor)
    }
}
