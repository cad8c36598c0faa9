//! Plain text in columns.

use std::io::IsTerminal;

/// Columns that fit on standard output: 80 where it is no terminal.
pub fn width() -> usize {
    if !std::io::stdout().is_terminal() {
        return 80;
    }
    std::env::var("COLUMNS").ok().and_then(|c| c.parse().ok()).unwrap_or(100usize).clamp(40, 160)
}

/// `text` in lines of at most `width` columns, each after `indent` spaces; the first follows `head`.
pub fn hang(head: &str, indent: usize, text: &str, width: usize) -> String {
    let mut lines = Vec::new();
    let mut line = format!("{head:<indent$}");
    // A head without a blank behind it has a line of its own.
    if !head.is_empty() && head.chars().count() >= indent {
        lines.push(line.trim_end().to_owned());
        line = " ".repeat(indent);
    }
    let mut empty = true;
    for word in text.split_whitespace() {
        if !empty && line.chars().count() + 1 + word.chars().count() > width {
            lines.push(line);
            line = " ".repeat(indent);
            empty = true;
        }
        if !empty {
            line.push(' ');
        }
        line.push_str(word);
        empty = false;
    }
    lines.push(line.trim_end().to_owned());
    lines.join("\n") + "\n"
}

/// Rows in columns: the first column to the left, all others to the right.
pub fn table(rows: &[Vec<String>]) -> String {
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width_of =
        |c: usize| rows.iter().filter_map(|r| r.get(c)).map(|s| s.chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..columns).map(width_of).collect();
    let mut text = String::new();
    for row in rows {
        let cells = row.iter().zip(&widths).enumerate().map(|(i, (cell, &width))| {
            if i == 0 { format!("{cell:<width$}") } else { format!("{cell:>width$}") }
        });
        text.push_str(cells.collect::<Vec<_>>().join("  ").trim_end());
        text.push('\n');
    }
    text
}

/// A count with its thousands set apart.
pub fn count(number: u64) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// A number above 0 with about two digits that count.
pub fn rough(number: f64) -> String {
    match number {
        _ if number < 0.001 => "0.001".to_owned(),
        _ if number < 0.1 => format!("{number:.3}"),
        _ if number < 10.0 => format!("{number:.2}"),
        _ => format!("{number:.0}"),
    }
}

/// Bytes for people.
pub fn bytes(number: u64) -> String {
    match number {
        0..1024 => format!("{number} B"),
        1024..1_048_576 => format!("{:.1} KiB", number as f64 / 1024.0),
        _ => format!("{:.1} MiB", number as f64 / 1_048_576.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_stay_within_their_width_and_hang() {
        let text = hang("  name", 10, &"word ".repeat(40), 40);
        assert!(text.lines().all(|line| line.chars().count() <= 40), "{text}");
        assert!(text.starts_with("  name    word word"), "{text}");
        assert!(text.lines().skip(1).all(|line| line.starts_with("          word")), "{text}");
        assert!(hang("a-long-name-indeed", 6, "x", 40).starts_with("a-long-name-indeed\n      x"));
    }

    #[test]
    fn numbers_for_people() {
        assert_eq!([count(7), count(1234), count(519_168)], ["7", "1,234", "519,168"]);
        assert_eq!([0.0, 0.0456, 0.456, 4.56, 45.6].map(rough), ["0.001", "0.046", "0.46", "4.56", "46"]);
        assert_eq!([bytes(12), bytes(2048), bytes(16 << 20)], ["12 B", "2.0 KiB", "16.0 MiB"]);
    }
}
