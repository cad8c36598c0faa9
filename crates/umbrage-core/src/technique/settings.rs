//! A technique with its parameters, as a user asked for it.

use super::choices::Choice;
use super::combination::Combination;
use super::volume::Soften;
use super::{Family, Method, Param, ParamDefault, Technique, find};

/// A technique with every choice and parameter settled.
#[derive(Clone, Debug)]
pub struct Settings {
    /// The row of the table that it began with.
    pub technique: &'static Technique,
    /// Its family with all choices made.
    pub method: Method,
    set: Vec<(&'static str, f32)>,
}

/// Why a setting was refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SettingError {
    /// No technique of that name.
    #[error("there is no technique `{id}`{suggestion}; `umbrage techniques` lists them")]
    UnknownTechnique {
        /// What was asked for.
        id: String,
        /// `; did you mean ...?` or nothing.
        suggestion: String,
    },
    /// No parameter or choice of that name in this technique.
    #[error("`{technique}` has no setting `{key}`{suggestion}; it has {known}")]
    UnknownKey {
        /// Which technique.
        technique: &'static str,
        /// What was asked for.
        key: String,
        /// `; did you mean ...?` or nothing.
        suggestion: String,
        /// All that it has.
        known: String,
    },
    /// A choice that is not in its table.
    #[error("`{key}` cannot be `{value}`{suggestion}; it is one of {known}")]
    UnknownChoice {
        /// Which table.
        key: String,
        /// What was asked for.
        value: String,
        /// `; did you mean ...?` or nothing.
        suggestion: String,
        /// The table's names.
        known: String,
    },
    /// Not a number, or not in its range.
    #[error("`{key}` is `{value}`; it must be {allowed}")]
    OutOfRange {
        /// Which parameter.
        key: String,
        /// What was asked for.
        value: String,
        /// Range and unit.
        allowed: String,
    },
    /// Two settings of one key.
    #[error("`{key}` is set twice; keep one of them")]
    Twice {
        /// Which key.
        key: String,
    },
    /// Choices that do not go together.
    #[error("these do not go together: {reason}")]
    Combination {
        /// Why.
        reason: &'static str,
    },
}

/// `; did you mean ...?` when a known name is near enough, otherwise nothing.
pub(super) fn suggest<'a>(asked: &str, known: impl Iterator<Item = &'a str>) -> String {
    known
        .map(|name| (strsim::jaro_winkler(&asked.to_lowercase(), name), name))
        .filter(|(likeness, _)| *likeness > 0.7)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, name)| format!("; did you mean `{name}`?"))
        .unwrap_or_default()
}

impl PartialEq for Settings {
    /// Do both draw the same? Values that are set to their defaults count as not set.
    fn eq(&self, other: &Self) -> bool {
        self.technique.id == other.technique.id
            && self.method == other.method
            && self.params().all(|param| self.value(param.name) == other.value(param.name))
    }
}

impl Settings {
    /// Does the key name a table of choices, of any family?
    pub fn is_choice(key: &str) -> bool {
        Family::WITH_CHOICES.iter().any(|family| family.tables().iter().any(|table| table.key == key))
    }

    /// The technique `id` with `key=value` pairs over its defaults. Choices count before parameters, whatever their
    /// order.
    ///
    /// # Errors
    /// [`SettingError`] names what is unknown or out of range, with the nearest name that exists.
    pub fn new<'a>(
        id: &str,
        pairs: impl IntoIterator<Item = (&'a str, &'a str)>,
    ) -> Result<Self, SettingError> {
        let technique = find(id)?;
        let mut settings = Self { technique, method: technique.method, set: Vec::new() };
        let (choices, params): (Vec<_>, Vec<_>) =
            pairs.into_iter().partition(|(key, _)| Self::is_choice(key));
        for (i, (key, value)) in choices.iter().enumerate() {
            if choices[..i].iter().any(|(other, _)| other == key) {
                return Err(SettingError::Twice { key: (*key).to_owned() });
            }
            settings.choose(key, value)?;
        }
        if let Some(reason) = settings.combination().as_ref().and_then(Combination::objection) {
            return Err(SettingError::Combination { reason });
        }
        for (key, value) in params {
            settings.put(key, value)?;
        }
        Ok(settings)
    }

    /// The five choices of a map, where the technique is one.
    pub fn combination(&self) -> Option<Combination> {
        self.method.combination()
    }

    /// What takes over for casters that the technique's family cannot draw: the default map. `None` for maps, which can draw all,
    /// and without shadows.
    pub fn fallback(&self) -> Option<Self> {
        match self.method {
            Method::None | Method::Map(_) => None,
            Method::Volume(_) | Method::Mask(_) => {
                let technique = find(super::DEFAULT).ok()?;
                let set = self.set.iter().filter(|(key, _)| *key == "map_size").copied().collect();
                Some(Self { technique, method: technique.method, set })
            }
        }
    }

    /// The parameters that these choices have.
    pub fn params(&self) -> impl Iterator<Item = &'static Param> {
        self.method.params().into_iter()
    }

    /// The value of a parameter: as set, or its default. `None` when this combination has no such parameter.
    pub fn value(&self, name: &str) -> Option<f32> {
        let param = self.method.param(name)?;
        Some(self.set_value(name).unwrap_or_else(|| match param.default {
            ParamDefault::Fixed(value) => value,
            ParamDefault::Derived { value, .. } => value(self.reach_texel()),
        }))
    }

    /// The value of a parameter where it was set; `None` where its default counts, or where there is none of that name.
    pub fn set_value(&self, name: &str) -> Option<f32> {
        self.set.iter().find(|(key, _)| *key == name).map(|(_, value)| *value)
    }

    /// The same with a parameter set, or set anew.
    ///
    /// # Errors
    /// [`SettingError`] where this technique has no such parameter, or the number is out of its range.
    pub fn with_value(mut self, name: &str, value: f32) -> Result<Self, SettingError> {
        self.set.retain(|(key, _)| *key != name);
        self.put(name, &value.to_string())?;
        Ok(self)
    }

    /// Width and height of the map, texels; 0 without a map.
    pub fn map_size_texel(&self) -> u32 {
        self.value("map_size").map_or(0, |size| size as u32)
    }

    /// How far from the receiver, along either axis of the map, the centre of a texel may lie that counts, texels; 0
    /// without a map.
    pub fn reach_texel(&self) -> f32 {
        self.combination().map_or(0.0, |c| c.reach_texel(self.value("width").unwrap_or(1.0)))
    }

    /// From how many places an area light is seen.
    pub fn places(&self) -> u32 {
        self.value("views").map_or(1, |views| views as u32)
    }

    /// Lookups of the map for each lit pixel and view: a gather counts once.
    pub fn taps(&self) -> u32 {
        if let Method::Volume(volume) = self.method {
            // One of V; and two rows of neighbours where it is blurred, as wide as it is by pixels.
            let radius_px = 0.5 * self.value("soft_px").unwrap_or(0.0);
            let blurred = if volume.soften == Soften::Blur {
                2 * (2 * radius_px.ceil().max(1.0) as u32 - 1)
            } else {
                0
            };
            return 1 + blurred;
        }
        self.combination().map_or(0, |c| c.taps(self.value("width").unwrap_or(1.0)))
    }

    fn unknown_key(&self, key: &str) -> SettingError {
        let mut known: Vec<&str> = self.params().map(|p| p.name).collect();
        known.extend(self.method.rows().iter().map(|(key, _)| *key));
        // A parameter of a choice that was not made.
        let tables = self.method.family().tables();
        let has = |row: &&&Choice| row.params.iter().any(|param| param.name == key);
        let elsewhere = tables.iter().find_map(|table| Some((table.key, table.rows.iter().find(has)?.id)));
        let suggestion = match elsewhere {
            Some((table, id)) => format!("; it comes with {table}={id}"),
            None => suggest(key, known.iter().copied()),
        };
        SettingError::UnknownKey {
            technique: self.technique.id,
            key: key.to_owned(),
            suggestion,
            known: if known.is_empty() { "none".to_owned() } else { known.join(", ") },
        }
    }

    fn choose(&mut self, key: &str, value: &str) -> Result<(), SettingError> {
        let tables = self.method.family().tables();
        let Some(table) = tables.iter().find(|table| table.key == key) else {
            return Err(self.unknown_key(key));
        };
        let known = || table.rows.iter().map(|row| row.id);
        self.method = self.method.choose(key, value).ok_or_else(|| SettingError::UnknownChoice {
            key: key.to_owned(),
            value: value.to_owned(),
            suggestion: suggest(value, known()),
            known: known().collect::<Vec<_>>().join(", "),
        })?;
        Ok(())
    }

    fn put(&mut self, key: &str, value: &str) -> Result<(), SettingError> {
        let param = self.params().find(|p| p.name == key).ok_or_else(|| self.unknown_key(key))?;
        if self.set.iter().any(|(other, _)| *other == param.name) {
            return Err(SettingError::Twice { key: key.to_owned() });
        }
        let number = value.trim().parse::<f32>().ok().filter(|v| (param.min..=param.max).contains(v));
        let whole = param.step == 1.0;
        let number =
            number.filter(|v| !whole || v.fract() == 0.0).ok_or_else(|| SettingError::OutOfRange {
                key: key.to_owned(),
                value: value.to_owned(),
                allowed: format!(
                    "a {}number from {} to {} ({})",
                    if whole { "whole " } else { "" },
                    param.min,
                    param.max,
                    param.unit
                ),
            })?;
        self.set.push((param.name, number));
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(id: &str, pairs: &[(&str, &str)]) -> String {
        Settings::new(id, pairs.iter().copied()).expect_err("must be refused").to_string()
    }

    #[test]
    fn defaults_follow_the_combination() {
        let slope = |id, pairs: &[(&str, &str)]| {
            Settings::new(id, pairs.iter().copied()).expect("valid").value("slope_factor")
        };
        let by_slope = ("bias", "slope");
        assert_eq!(slope("linear", &[]), None, "what is automatic has nothing to set");
        assert_eq!(slope("hard", &[by_slope]), Some(1.0));
        assert_eq!(slope("linear", &[by_slope]), Some(2.0));
        assert_eq!(slope("linear", &[by_slope, ("filter", "nearest")]), Some(1.0));
        assert_eq!(slope("pcf", &[by_slope]), Some(6.0));
        assert_eq!(slope("pcf", &[by_slope, ("width", "9")]), Some(10.0));
        assert_eq!(slope("linear", &[by_slope, ("slope_factor", "3.5")]), Some(3.5));
        assert_eq!(slope("matrix-bias", &[]), None);
        assert_eq!(slope("unshadowed", &[]), None);
    }

    fn settings_of(width: &str) -> Settings {
        Settings::new("pcf", [("width", width)]).expect("valid")
    }

    #[test]
    fn a_value_can_be_set_anew_and_is_refused_like_any_other() {
        let settings = Settings::new("pcf", [("width", "3")]).expect("valid");
        assert_eq!((settings.set_value("width"), settings.set_value("map_size")), (Some(3.0), None));
        let wider = settings.with_value("width", 7.0).expect("in range");
        assert_eq!(wider.value("width"), Some(7.0));
        assert_ne!(wider, settings_of("3"));
        assert_eq!(settings_of("5"), Settings::new("pcf", []).expect("5 is the default"));
        assert!(wider.clone().with_value("width", 2.5).expect_err("whole").to_string().contains("whole"));
        assert!(wider.with_value("soft_px", 2.0).is_err());
    }

    #[test]
    fn choices_count_before_parameters() {
        let settings = Settings::new("linear", [("matrix_bias", "0.01"), ("bias", "matrix")]).expect("valid");
        assert_eq!(settings.value("matrix_bias"), Some(0.01));
    }

    #[test]
    fn what_is_refused_says_why_and_what_is_near() {
        assert!(refused("liner", &[]).contains("did you mean `linear`?"));
        assert!(refused("zzz", &[]).contains("umbrage techniques"));
        assert!(refused("linear", &[("map_sise", "1")]).contains("did you mean `map_size`?"));
        assert!(refused("linear", &[("filter", "liner")]).contains("did you mean `linear`?"));
        assert!(refused("unshadowed", &[("filter", "linear")]).contains("it has none"));
        assert!(refused("volume", &[("soft_px", "9")]).contains("it comes with soften=blur"));
        assert!(refused("linear", &[("width", "9")]).contains("it comes with filter=pcf"));
        for bad in ["0", "-1", "20000", "2.5", "NaN", "inf", "big", ""] {
            let message = refused("linear", &[("map_size", bad)]);
            assert!(message.contains("whole number from 1 to 16384 (texel)"), "{bad}: {message}");
        }
        assert!(
            refused("linear", &[("bias", "constant"), ("constant", "1"), ("constant", "2")])
                .contains("twice")
        );
        assert!(refused("linear", &[("bias", "none"), ("bias", "slope")]).contains("twice"));
    }
}
