//! Bytes to numbered lines: continuation joined, any encoding survived. OBJ, MTL and what splits OBJ share it.

use std::borrow::Cow;

/// Lines with the number, from 1, at which each starts.
pub(crate) struct Lines<'a> {
    rest: &'a [u8],
    separator: u8,
    number: usize,
}

impl<'a> Lines<'a> {
    /// Lines of a whole file. A file without any `\n` is taken for an old Macintosh one, whose lines end in `\r`.
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        let rest = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        let separator = if rest.contains(&b'\n') { b'\n' } else { b'\r' };
        Self { rest, separator, number: 0 }
    }

    /// Bytes that are not read yet.
    pub(crate) fn remaining(&self) -> usize {
        self.rest.len()
    }

    fn take(&mut self) -> &'a [u8] {
        self.number += 1;
        let (line, rest) = match self.rest.iter().position(|b| *b == self.separator) {
            Some(end) => (&self.rest[..end], &self.rest[end + 1..]),
            None => (self.rest, &[][..]),
        };
        self.rest = rest;
        line.trim_ascii()
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = (usize, Cow<'a, str>);

    fn next(&mut self) -> Option<Self::Item> {
        if self.rest.is_empty() {
            return None;
        }
        let mut line = self.take();
        let number = self.number;
        if !line.ends_with(b"\\") || line.starts_with(b"#") {
            return Some((number, String::from_utf8_lossy(line)));
        }
        let mut joined = Vec::new();
        while let Some(part) = line.strip_suffix(b"\\") {
            joined.extend_from_slice(part);
            joined.push(b' ');
            line = if self.rest.is_empty() { &[] } else { self.take() };
        }
        joined.extend_from_slice(line);
        Some((number, Cow::Owned(String::from_utf8_lossy(joined.trim_ascii()).into_owned())))
    }
}

/// The first word and what follows it, both trimmed.
pub(crate) fn keyword(line: &str) -> (&str, &str) {
    line.split_once(char::is_whitespace).map_or((line, ""), |(key, rest)| (key, rest.trim()))
}

/// What the file says, made fit for a message of one line: quoted, escaped, cut.
pub(crate) fn quoted(text: &str) -> String {
    let short: String = text.chars().take(40).collect();
    let dots = if short.len() < text.len() { "..." } else { "" };
    format!("{short:?}{dots}")
}

/// A number that is finite as `f32`.
pub(crate) fn finite(word: &str) -> Option<f32> {
    word.parse().ok().filter(|x: &f32| x.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(bytes: &[u8]) -> Vec<(usize, String)> {
        Lines::new(bytes).map(|(n, l)| (n, l.into_owned())).collect()
    }

    #[test]
    fn continued_lines_keep_the_number_of_their_first() {
        let lines = all(b"v 1\nf 1 2 \\\r\n 3 4\nl\\");
        let expected = [(1, "v 1"), (2, "f 1 2  3 4"), (4, "l")].map(|(n, l)| (n, l.to_owned()));
        assert_eq!(lines, expected);
    }

    #[test]
    fn old_macintosh_files_and_byte_order_marks_are_read() {
        assert_eq!(all(b"\xef\xbb\xbfv 1\rv 2"), [(1, "v 1".to_owned()), (2, "v 2".to_owned())]);
        assert_eq!(all(b""), []);
    }

    #[test]
    fn what_is_quoted_stays_on_one_line_and_short() {
        let text = quoted(&"a\nb".repeat(50));
        assert!(!text.contains('\n') && text.len() < 80, "{text}");
    }
}
