//! OBJ records with the bytes that they were read from.

use crate::obj::lines::{Lines, keyword};
use std::borrow::Cow;

/// A record: one line, or several that are continued.
pub(super) struct Record<'a> {
    /// Line where it starts, from 1.
    pub number: usize,
    /// Everything, with the line's end where there is one.
    pub raw: &'a [u8],
    text: Cow<'a, str>,
}

impl Record<'_> {
    /// First word, and the rest, continuations joined.
    pub(super) fn parts(&self) -> (&str, &str) {
        keyword(&self.text)
    }
}

/// All records of a file. Their `raw` together is the file, less a byte order mark.
pub(super) struct Records<'a> {
    bytes: &'a [u8],
    lines: Lines<'a>,
}

impl<'a> Records<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, lines: Lines::new(bytes) }
    }

    /// How many bytes come before the first record.
    pub(super) fn start(bytes: &[u8]) -> usize {
        bytes.len() - Lines::new(bytes).remaining()
    }
}

impl<'a> Iterator for Records<'a> {
    type Item = Record<'a>;

    fn next(&mut self) -> Option<Record<'a>> {
        let start = self.bytes.len() - self.lines.remaining();
        let (number, text) = self.lines.next()?;
        let raw = &self.bytes[start..self.bytes.len() - self.lines.remaining()];
        Some(Record { number, raw, text })
    }
}

/// What ends the file's lines.
pub(super) fn line_end(bytes: &[u8]) -> &'static [u8] {
    match bytes.iter().position(|b| *b == b'\n') {
        Some(at) if at > 0 && bytes[at - 1] == b'\r' => b"\r\n",
        None if bytes.contains(&b'\r') => b"\r",
        _ => b"\n",
    }
}

/// The comment at a record's end, or the blanks and the line's end if it has none.
pub(super) fn tail(raw: &[u8]) -> &[u8] {
    let after_blank = |at: usize| at > 0 && raw[at - 1].is_ascii_whitespace();
    match (0..raw.len()).find(|&at| raw[at] == b'#' && after_blank(at)) {
        Some(at) => &raw[at - 1..],
        None => &raw[raw.trim_ascii_end().len()..],
    }
}

/// First word that is a vertex, of records that name vertices.
fn first_reference(key: &str) -> Option<usize> {
    match key {
        "p" | "l" | "f" | "fo" | "bsp" | "bzp" => Some(1),
        "cdc" | "cdp" => Some(2),
        // After two or four limits of parameters.
        "curv" => Some(3),
        "surf" => Some(5),
        _ => None,
    }
}

/// The record with references that count backwards to positions and normals counted from the start; `None` where it
/// has none. `seen` positions, texture coordinates and normals come before it. All other bytes stay.
pub(super) fn absolute(record: &Record<'_>, seen: [usize; 3]) -> Option<Vec<u8>> {
    let first = first_reference(record.parts().0)?;
    let mut out = Vec::with_capacity(record.raw.len());
    let (mut word, mut changed, mut rest) = (0, false, record.raw);
    while !rest.is_empty() {
        let blank = rest.iter().position(|b| !b.is_ascii_whitespace()).unwrap_or(rest.len());
        out.extend_from_slice(&rest[..blank]);
        rest = &rest[blank..];
        if rest.first() == Some(&b'#') {
            break;
        }
        let end = rest.iter().position(|b| b.is_ascii_whitespace()).unwrap_or(rest.len());
        let (token, after) = rest.split_at(end);
        // A backslash that continues the line may touch the word before it.
        let core = token.strip_suffix(b"\\").unwrap_or(token);
        if word >= first {
            changed |= absolute_word(core, seen, &mut out);
        } else {
            out.extend_from_slice(core);
        }
        out.extend_from_slice(&token[core.len()..]);
        word += usize::from(!core.is_empty());
        rest = after;
    }
    out.extend_from_slice(rest);
    changed.then_some(out)
}

fn absolute_word(word: &[u8], seen: [usize; 3], out: &mut Vec<u8>) -> bool {
    let mut changed = false;
    for (kind, part) in word.split(|b| *b == b'/').enumerate() {
        if kind > 0 {
            out.push(b'/');
        }
        let number = std::str::from_utf8(part).ok().and_then(|text| text.parse::<i64>().ok());
        let moved = matches!(kind, 0 | 2);
        match number.filter(|n| *n < 0 && moved).and_then(|n| n.checked_add(seen[kind] as i64 + 1)) {
            Some(n) if n > 0 => {
                out.extend_from_slice(n.to_string().as_bytes());
                changed = true;
            }
            _ => out.extend_from_slice(part),
        }
    }
    changed
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rewritten(text: &str) -> Option<String> {
        let record = Records::new(text.as_bytes()).next().expect("a record");
        absolute(&record, [10, 20, 30]).map(|bytes| String::from_utf8(bytes).expect("UTF-8"))
    }

    #[test]
    fn records_together_are_the_file() {
        let text = b"\xef\xbb\xbf# \xff\r\nv 1 \\\r\n 2 3\r\n\r\n  f 1 2 3 # \xfe";
        let raw: Vec<u8> = Records::new(text).flat_map(|r| r.raw.to_vec()).collect();
        assert_eq!((&text[..Records::start(text)], &raw[..]), (&text[..3], &text[3..]));
        let last = Records::new(text).last().expect("a record");
        assert_eq!((last.number, tail(last.raw)), (5, &b" # \xfe"[..]));
        assert_eq!(
            [&b"a\r\nb\n"[..], b"a\rb", b"a\nb", b"a"].map(line_end),
            [&b"\r\n"[..], b"\r", b"\n", b"\n"]
        );
    }

    #[test]
    fn only_what_counts_backwards_is_written_anew() {
        for (text, expected) in [
            ("l -1 2/-3  -10/4\r\n", Some("l 10 2/-3  1/4\r\n")),
            ("curv -1 -2 -3 \\\n\t4 -5\\\n # -1\n", Some("curv -1 -2 8 \\\n\t4 6\\\n # -1\n")),
            ("surf -1 1 -1 1 -2/-1/-5 3/1/1", Some("surf -1 1 -1 1 9/-1/26 3/1/1")),
            ("l 1 2 3", None),
            ("p -11", None),
            ("p -9223372036854775808", None),
            ("parm u -1 -2", None),
            ("# -1", None),
        ] {
            assert_eq!(rewritten(text).as_deref(), expected, "{text}");
        }
    }
}
