//! Numbers as messages name them.

/// So many of a thing: "1 face", "2 faces".
pub(crate) fn counted(count: usize, thing: &str) -> String {
    format!("{count} {thing}{}", if count == 1 { "" } else { "s" })
}

/// Five significant digits, in plain notation where that is short.
pub(crate) fn short(value: f64) -> String {
    rounded(value, 5)
}

/// So many significant digits.
pub(crate) fn rounded(value: f64, digits: usize) -> String {
    let text = format!("{value:.*e}", digits - 1);
    let plain = value == 0.0 || (1e-4..10.0_f64.powi(digits as i32 + 2)).contains(&value.abs());
    text.parse().ok().filter(|_| plain).map_or(text, |rounded: f64| rounded.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_is_not_many() {
        assert_eq!([0, 1, 2].map(|n| counted(n, "face")), ["0 faces", "1 face", "2 faces"]);
    }

    #[test]
    fn numbers_are_plain_where_that_is_short() {
        let texts = [0.0, 0.25, 1.0 / 3.0, 123_456.789, 1e7, -2e-5, 1e300].map(short);
        assert_eq!(texts, ["0", "0.25", "0.33333", "123460", "1.0000e7", "-2.0000e-5", "1.0000e300"]);
    }
}
