//! Conditions on faces: which of them a file gets.

use crate::curvature::{FaceClass, FaceCurvature, Method};
use crate::error::Error;
use crate::mesh::Face;
use crate::quantity::Quantity;
use std::fmt;
use std::str::FromStr;

/// Comparisons that a face must all fulfil, such as `class=hyperbolic and k_max>0.1`.
///
/// A comparison is a column of the CSV, an operator (`=`, `!=`, `<`, `<=`, `>`, `>=`) and a number in the
/// input's units. With `=` and `!=` it may also be a range `LOW:HIGH`, ends included, and for `class` and
/// `method` a name or several separated by commas. `and` joins comparisons. A value that a face does not
/// have fulfils none.
#[derive(Clone, Debug, PartialEq)]
pub struct Condition {
    text: String,
    comparisons: Vec<Comparison>,
}

#[derive(Clone, Debug, PartialEq)]
struct Comparison {
    quantity: Quantity,
    component: usize,
    negated: bool,
    test: Test,
}

/// What a value is compared with. Numbers are rounded to 32 bits, as the values are, so that a number
/// copied from a CSV equals the value it stands for.
#[derive(Clone, Debug, PartialEq)]
enum Test {
    Below(f64),
    Above(f64),
    AtMost(f64),
    AtLeast(f64),
    Within(f64, f64),
    Classes(Vec<FaceClass>),
    Methods(Vec<Method>),
}

impl Condition {
    /// True for a face that fulfils all comparisons.
    pub fn holds(&self, face: Face, value: &FaceCurvature) -> bool {
        self.comparisons.iter().all(|comparison| comparison.holds(face, value))
    }

    /// True when a quantity is compared.
    pub fn uses(&self, quantity: Quantity) -> bool {
        self.comparisons.iter().any(|comparison| comparison.quantity == quantity)
    }
}

impl FromStr for Condition {
    type Err = Error;

    /// # Errors
    /// [`Error::Usage`] with the comparison that cannot be read, and what can.
    fn from_str(text: &str) -> Result<Self, Error> {
        let words: Vec<&str> = text.split_whitespace().collect();
        if words.iter().any(|word| word.eq_ignore_ascii_case("or")) {
            let what = "comparisons are joined by and, not by or; a range such as mean=-1:1 and a list such as \
                        class=elliptic,umbilic stand for one of several";
            return Err(Error::Usage(what.into()));
        }
        let comparisons: Result<Vec<Comparison>, String> = words
            .split(|word| word.eq_ignore_ascii_case("and"))
            .map(|part| Comparison::parse(&part.concat()))
            .collect();
        match comparisons {
            Ok(comparisons) => Ok(Condition { text: words.join(" "), comparisons }),
            Err(why) => Err(Error::Usage(why)),
        }
    }
}

impl fmt::Display for Condition {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl Comparison {
    fn parse(text: &str) -> Result<Self, String> {
        let operator = |c: char| "=<>!".contains(c);
        let start = text.find(operator).ok_or_else(|| match text {
            "" => "a comparison such as k_max>0.1 is missing".to_owned(),
            _ => format!("\"{text}\" compares nothing: write NAME=VALUE, or !=, <, <=, > or >= for the ="),
        })?;
        let (name, rest) = text.split_at(start);
        let (operator, value) = rest.split_at(rest.find(|c| !operator(c)).unwrap_or(rest.len()));
        let (quantity, component) = column(name).ok_or_else(|| {
            let known: Vec<&str> = Quantity::ALL.iter().flat_map(|q| q.columns()).copied().collect();
            format!("unknown column \"{name}\" in \"{text}\"; known are {}", known.join(", "))
        })?;
        let is_word = matches!(quantity, Quantity::Class | Quantity::Method);
        let of = |test| Ok(Comparison { quantity, component, negated: operator == "!=", test });
        match operator {
            "=" | "!=" if quantity == Quantity::Class => of(Test::Classes(words(value, class)?)),
            "=" | "!=" if quantity == Quantity::Method => of(Test::Methods(words(value, method)?)),
            _ if is_word => Err(format!("{name} has no order: \"{text}\" must be {name}=NAME or {name}!=NAME")),
            "=" | "!=" => {
                let (low, high) = value.split_once(':').unwrap_or((value, value));
                let (low, high) = (number(low, quantity, text)?, number(high, quantity, text)?);
                if low > high {
                    return Err(format!(
                        "the range {value} of {name} is empty: its first number must not be the larger"
                    ));
                }
                of(Test::Within(low, high))
            }
            "<" => of(Test::Below(number(value, quantity, text)?)),
            "<=" => of(Test::AtMost(number(value, quantity, text)?)),
            ">" => of(Test::Above(number(value, quantity, text)?)),
            ">=" => of(Test::AtLeast(number(value, quantity, text)?)),
            _ => Err(format!("\"{operator}\" in \"{text}\" is none of =, !=, <, <=, > and >=")),
        }
    }

    fn holds(&self, face: Face, of: &FaceCurvature) -> bool {
        // Face numbers beyond 2^24 have no 32-bit float of their own.
        let value = match self.quantity {
            Quantity::Face => f64::from(face.0),
            quantity => f64::from(quantity.value(face, of, self.component)),
        };
        let holds = match &self.test {
            Test::Classes(classes) => classes.contains(&of.class),
            Test::Methods(methods) => methods.contains(&of.method),
            _ if value.is_nan() => return false,
            Test::Below(limit) => value < *limit,
            Test::Above(limit) => value > *limit,
            Test::AtMost(limit) => value <= *limit,
            Test::AtLeast(limit) => value >= *limit,
            Test::Within(low, high) => (*low..=*high).contains(&value),
        };
        holds != self.negated
    }
}

/// The quantity of a column and which of its components that is.
fn column(name: &str) -> Option<(Quantity, usize)> {
    let find = |quantity: Quantity| Some((quantity, quantity.columns().iter().position(|column| *column == name)?));
    Quantity::ALL.into_iter().find_map(find)
}

fn number(text: &str, quantity: Quantity, whole: &str) -> Result<f64, String> {
    let number: f64 = text.parse().ok().filter(|number: &f64| !number.is_nan()).ok_or_else(|| match text {
        "" => format!("\"{whole}\" lacks a number"),
        _ => format!("\"{text}\" in \"{whole}\" is no number (comparisons are joined by and)"),
    })?;
    Ok(if quantity == Quantity::Face { number } else { f64::from(number as f32) })
}

/// Names separated by commas.
fn words<T>(text: &str, known: impl Fn(&str) -> Result<T, String>) -> Result<Vec<T>, String> {
    text.split(',').map(known).collect()
}

fn class(name: &str) -> Result<FaceClass, String> {
    let token = |class: FaceClass| class.name().replace(' ', "_");
    let find = |class: &FaceClass| token(*class) == name || class.code().to_string() == name;
    FaceClass::ALL.into_iter().find(find).ok_or_else(|| {
        let known: Vec<String> = FaceClass::ALL.into_iter().map(token).collect();
        format!("unknown class \"{name}\"; known are {}", known.join(", "))
    })
}

fn method(name: &str) -> Result<Method, String> {
    let known = || Method::ALL.into_iter().filter(|method| *method != Method::None);
    known().find(|method| method.name() == name).ok_or_else(|| {
        let known: Vec<&str> = known().map(Method::name).collect();
        format!("unknown method \"{name}\"; known are {}", known.join(", "))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    fn saddle() -> FaceCurvature {
        FaceCurvature {
            k_max: 0.1,
            k_min: -0.5,
            dir_max: Vec3::X,
            dir_min: Vec3::Y,
            method: Method::Fit,
            class: FaceClass::Hyperbolic,
            ..FaceCurvature::NOT_ESTIMATED
        }
    }

    fn holds(condition: &str, value: &FaceCurvature) -> bool {
        let parsed: Condition = condition.parse().unwrap_or_else(|e| panic!("{condition}: {e}"));
        parsed.holds(Face(20_000_001), value)
    }

    #[test]
    fn a_face_is_held_against_every_comparison() {
        for (condition, expected) in [
            ("class=hyperbolic", true),
            ("class = flat,hyperbolic", true),
            ("class=4", true),
            ("class!=hyperbolic", false),
            ("class=not_estimated", false),
            ("method=fit", true),
            ("k_max=0.1", true),
            ("k_max>0.1", false),
            ("k_max>=0.1", true),
            ("k_max < 0.2 and k_min < -0.4 AND mean=-0.3:0", true),
            ("k_max<0.2 and k_min<-0.6", false),
            ("k_max=0.05:0.2", true),
            ("k_max!=0.05:0.2", false),
            ("k_min=-inf:-0.5", true),
            ("dir_max_x>0.9", true),
            ("face=20000001", true),
            ("face=20000000", false),
            ("radius>0", false),
            ("radius!=7", false),
        ] {
            assert_eq!(holds(condition, &saddle()), expected, "{condition}");
        }
    }

    #[test]
    fn a_face_without_estimate_has_no_value_to_compare() {
        let none = FaceCurvature::NOT_ESTIMATED;
        for condition in ["k_max>0", "k_max<=0", "k_max!=3", "k_max=-inf:inf"] {
            assert!(!holds(condition, &none), "{condition}");
        }
        assert!(holds("class=not_estimated", &none) && holds("class=-1 and face>7", &none));
    }

    #[test]
    fn what_cannot_be_read_is_named() {
        for (condition, what) in [
            ("", "is missing"),
            ("k_max>1 and", "is missing"),
            ("k_max", "compares nothing"),
            ("k_mux>1", "unknown column \"k_mux\""),
            ("dir_max>1", "unknown column \"dir_max\""),
            ("k_max>", "lacks a number"),
            ("k_max>big", "\"big\""),
            ("k_max>1 or k_min<0", "joined by and, not by or"),
            ("k_max>1, k_min<0", "joined by and"),
            ("k_max==1", "\"==\""),
            ("k_max=2:1", "is empty"),
            ("k_max>1:2", "is no number"),
            ("k_max=nan", "is no number"),
            ("class=saddle", "known are not_estimated, flat"),
            ("class>flat", "has no order"),
            ("method=", "unknown method"),
        ] {
            let error = condition.parse::<Condition>().expect_err(condition);
            assert!(error.is_usage() && error.to_string().contains(what), "{condition}: {error}");
        }
    }
}
