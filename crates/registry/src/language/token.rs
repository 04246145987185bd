//! Words, numbers, strings and signs of a text.

use super::tree::Span;

/// What a token is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum TokenKind {
    /// A name or a word of the language.
    Word(String),
    /// Digits, perhaps with a point, and the letters right behind them.
    Number { digits: String, unit: String },
    /// A text between quotation marks, its escapes replaced.
    String(String),
    /// One of `{ } ( ) = , +`.
    Sign(char),
    /// What cannot be read, and why.
    Bad(&'static str),
    /// The end of the text.
    End,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Token {
    pub(super) kind: TokenKind,
    pub(super) span: Span,
}

impl Token {
    pub(super) fn is_word(&self, word: &str) -> bool {
        matches!(&self.kind, TokenKind::Word(text) if text == word)
    }

    pub(super) fn is_sign(&self, sign: char) -> bool {
        self.kind == TokenKind::Sign(sign)
    }

    /// How a message names it.
    pub(super) fn described(&self) -> String {
        match &self.kind {
            TokenKind::Word(word) => format!("`{word}`"),
            TokenKind::Number { digits, unit } => format!("`{digits}{unit}`"),
            TokenKind::String(_) => "a text in quotation marks".to_owned(),
            TokenKind::Sign(sign) => format!("`{sign}`"),
            TokenKind::Bad(why) => (*why).to_owned(),
            TokenKind::End => "the end of the text".to_owned(),
        }
    }
}

/// The tokens of `text`; the last one is its end.
pub(super) fn tokens(text: &str) -> Vec<Token> {
    let mut tokens = Vec::new();
    let mut at = 0;
    while let Some(first) = text[at..].chars().next() {
        let rest = &text[at..];
        let length_while =
            |keep: &dyn Fn(char) -> bool| rest.find(|letter| !keep(letter)).unwrap_or(rest.len());
        let (kind, length) = match first {
            _ if first.is_whitespace() => {
                at += first.len_utf8();
                continue;
            }
            '#' => {
                at += length_while(&|letter| letter != '\n');
                continue;
            }
            '{' | '}' | '(' | ')' | '=' | ',' | '+' => (TokenKind::Sign(first), 1),
            '"' => string(rest),
            '0'..='9' => {
                let digits = length_while(&|letter| letter.is_ascii_digit() || letter == '.');
                let unit = length_while(&is_of_word);
                let unit = rest[digits..unit.max(digits)].to_owned();
                let length = digits + unit.len();
                (TokenKind::Number { digits: rest[..digits].to_owned(), unit }, length)
            }
            _ if is_of_word(first) => {
                let length = length_while(&is_of_word);
                (TokenKind::Word(rest[..length].to_owned()), length)
            }
            _ => (TokenKind::Bad("a sign that the language does not know"), first.len_utf8()),
        };
        tokens.push(Token { kind, span: Span { start: at, end: at + length } });
        at += length;
    }
    tokens.push(Token { kind: TokenKind::End, span: Span { start: text.len(), end: text.len() } });
    tokens
}

fn is_of_word(letter: char) -> bool {
    letter.is_alphanumeric() || matches!(letter, '-' | '_' | '.')
}

/// The token of a text that begins with a quotation mark, and its length.
fn string(text: &str) -> (TokenKind, usize) {
    let mut value = String::new();
    let mut letters = text.char_indices().skip(1);
    while let Some((at, letter)) = letters.next() {
        match letter {
            '"' => return (TokenKind::String(value), at + 1),
            '\n' => return (TokenKind::Bad("a text whose quotation mark is not closed"), at),
            '\\' => match letters.next() {
                Some((_, 'n')) => value.push('\n'),
                Some((_, 't')) => value.push('\t'),
                Some((_, sign @ ('"' | '\\'))) => value.push(sign),
                _ => {
                    const WHY: &str =
                        "a backslash that stands before none of `\"`, `\\`, `n` and `t`";
                    return (TokenKind::Bad(WHY), at + 1);
                }
            },
            _ => value.push(letter),
        }
    }
    (TokenKind::Bad("a text whose quotation mark is not closed"), text.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_of_each_kind() {
        let kinds: Vec<TokenKind> = tokens("do tilt-left+13 for 1.5s # why\n\"a \\\"b\\\"\" ;")
            .into_iter()
            .map(|token| token.kind)
            .collect();
        let word = |text: &str| TokenKind::Word(text.into());
        let number = |digits: &str, unit: &str| TokenKind::Number {
            digits: digits.into(),
            unit: unit.into(),
        };
        let expected = [
            word("do"),
            word("tilt-left"),
            TokenKind::Sign('+'),
            number("13", ""),
            word("for"),
            number("1.5", "s"),
            TokenKind::String("a \"b\"".into()),
            TokenKind::Bad("a sign that the language does not know"),
            TokenKind::End,
        ];
        assert_eq!(kinds, expected);
    }

    #[test]
    fn places_are_bytes_and_a_text_without_an_end_ends_with_its_line() {
        let tokens = tokens("é \"open\nnext");
        assert_eq!((tokens[0].span.start, tokens[0].span.end), (0, 2));
        assert_eq!((tokens[1].span.start, tokens[1].span.end), (3, 8));
        assert!(tokens[2].is_word("next"));
    }
}
