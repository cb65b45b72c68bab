//! Layout of a report's content: heading, sections and signature lines.

use krilla::image::Image;

use super::canvas::{LINE, MUTED_COLOUR, PageMark, TEXT};
use super::flow::{Flow, MARGIN, Style, WIDTH};
use super::table::{TableLayout, cell_style};
use super::typeface::Face;
use crate::drawing::Drawing;
use crate::report::{Block, Fact, Report, Section};

const BODY: Style = Style { face: Face::Text, size: 9.0, colour: TEXT };
const LABEL: Style = Style { face: Face::Text, size: 9.0, colour: MUTED_COLOUR };
const STRONG: Style = Style { face: Face::Strong, size: 9.0, colour: TEXT };
const TITLE: Style = Style { face: Face::Strong, size: 20.0, colour: TEXT };
const SECTION: Style = Style { face: Face::Strong, size: 12.0, colour: TEXT };
const HEADING: Style = Style { face: Face::Strong, size: 9.5, colour: TEXT };
const SIGNATURE: Style = Style { face: Face::Text, size: 8.0, colour: MUTED_COLOUR };

/// Width of the label in a label–value pair in points (45 mm).
const LABEL_WIDTH: f32 = 127.6;
/// Distance between a label and its value in points (4 mm).
const LABEL_GAP: f32 = 11.3;
/// Vertical distance between two label–value pairs, in points.
const FACT_GAP: f32 = 2.5;
/// Maximum number of lines in a label–value pair that is kept on one page.
const MAX_UNBROKEN_FACT_LINES: usize = 6;
/// Maximum line length of a paragraph, in points.
const MAX_LINE_LENGTH: f32 = 425.2;
/// Size of a drawing unit in points, unless the drawing would be wider than the page.
const DRAWING_UNIT: f32 = 0.75;
/// Height of the space above a signature line, in points.
const SIGNATURE_SPACE: f32 = 45.0;
/// Maximum height and width of a logo, in points.
const LOGO: (f32, f32) = (31.0, 142.0);

impl Flow<'_> {
    pub(super) fn place_report(&mut self, report: &Report, logo: Option<Image>, printed: &str) {
        self.place_header(report, logo);
        let hash = report.content_hash();
        let labels = &report.labels;
        let last = [
            Fact::code(&labels.number, hash.report_number()),
            Fact::code(&labels.content_hash, hash.to_string()),
            Fact::new(&labels.printed, printed),
        ];
        report.origin.iter().chain(&last).for_each(|fact| self.place_fact(fact));
        report.sections.iter().for_each(|section| self.place_section(section));
        self.place_footer(report);
    }

    fn place_header(&mut self, report: &Report, logo: Option<Image>) {
        let top = self.y;
        let mut x = MARGIN;
        let line_top = top + (LOGO.0 - STRONG.line_height()) / 2.0;
        if let Some(image) = logo {
            let (width, height) = image.size();
            let (width, height) = (width as f32, height as f32);
            let scale = (LOGO.0 / height.max(1.0)).min(LOGO.1 / width.max(1.0));
            let (width, height) = (width * scale, height * scale);
            self.push(PageMark::Image { x, y: top + (LOGO.0 - height) / 2.0, width, height, image });
            x += width + 8.0;
        }
        if let Some(company) = &report.company {
            self.text_at(x, line_top, STRONG, &company.name);
        }
        let right = MARGIN + WIDTH - self.width(LABEL, &report.subject);
        self.text_at(right, line_top, LABEL, &report.subject);
        self.y = top + LOGO.0 + 8.0;
        self.rule(MARGIN, self.y, WIDTH, 0.6, TEXT);
        self.y += 20.0;
        for line in self.lines(TITLE, &report.title, WIDTH) {
            self.text_at(MARGIN, self.y, TITLE, line);
            self.y += TITLE.size * 1.2;
        }
        self.y += 11.0;
    }

    fn place_fact(&mut self, fact: &Fact) {
        let style = cell_style(fact.style);
        let labels = self.lines(LABEL, &fact.label, LABEL_WIDTH);
        let values = self.lines(style, &fact.value, WIDTH - LABEL_WIDTH - LABEL_GAP);
        let count = labels.len().max(values.len());
        let lower = (BODY.size - style.size) * 1.05;
        // Keep a short label–value pair on one page.
        self.ensure_space(count.min(MAX_UNBROKEN_FACT_LINES) as f32 * BODY.line_height() + FACT_GAP);
        for number in 0..count {
            self.ensure_space(BODY.line_height());
            if let Some(line) = labels.get(number) {
                self.text_at(MARGIN, self.y, LABEL, line);
            }
            if let Some(line) = values.get(number) {
                self.text_at(MARGIN + LABEL_WIDTH + LABEL_GAP, self.y + lower, style, line);
            }
            self.y += BODY.line_height();
        }
        self.y += FACT_GAP;
    }

    fn place_section(&mut self, section: &Section) {
        let own = SECTION.line_height() + 10.0;
        let lead = own + self.lead_height(&section.blocks);
        self.ensure_space(22.0 + lead);
        self.add_space(22.0);
        for line in self.lines(SECTION, &section.title, WIDTH) {
            self.text_at(MARGIN, self.y, SECTION, line);
            self.y += SECTION.line_height();
        }
        self.y += 2.8;
        self.rule(MARGIN, self.y, WIDTH, 0.4, LINE);
        self.y += 7.0;
        let mut rest = section.blocks.as_slice();
        while let [block, after @ ..] = rest {
            if let Block::Heading(text) = block {
                self.ensure_space(HEADING.line_height() + 17.0 + self.lead_height(after));
                if !std::ptr::eq(rest, section.blocks.as_slice()) {
                    self.add_space(8.0);
                }
                self.text_at(MARGIN, self.y, HEADING, text);
                self.y += HEADING.line_height() + 4.0;
            } else {
                self.place_block(block);
            }
            rest = after;
        }
    }

    /// Returns the height of the content that must be on the same page as the heading before it.
    fn lead_height(&self, blocks: &[Block]) -> f32 {
        match blocks {
            [] => 0.0,
            [Block::Heading(_), after @ ..] => HEADING.line_height() + 12.0 + self.lead_height(after),
            [Block::Paragraph(text), Block::Paragraph(_), ..] => self.paragraph_height(text),
            // A paragraph explains the part that follows it.
            [Block::Paragraph(text), after @ ..] => self.paragraph_height(text) + self.lead_height(after),
            [Block::Facts(_), ..] => 2.0 * (BODY.line_height() + FACT_GAP),
            [Block::Table(table), ..] => TableLayout::new(self, table).lead_height(self),
            [Block::Drawing(drawing), ..] => drawing_height(drawing),
        }
    }

    fn paragraph_height(&self, text: &str) -> f32 {
        self.lines(BODY, text, MAX_LINE_LENGTH).len() as f32 * BODY.line_height() + 5.7
    }

    fn place_block(&mut self, block: &Block) {
        match block {
            Block::Heading(_) => {}
            Block::Paragraph(text) => self.place_paragraph(text, BODY, MAX_LINE_LENGTH),
            Block::Facts(facts) => {
                facts.iter().for_each(|fact| self.place_fact(fact));
                self.y += 4.0;
            }
            Block::Table(table) => TableLayout::new(self, table).place(self),
            Block::Drawing(drawing) => {
                let height = drawing_height(drawing);
                self.ensure_space(height);
                let scale = drawing_scale(drawing);
                self.push(PageMark::Drawing { x: MARGIN, y: self.y, scale, drawing: drawing.clone() });
                self.y += height;
            }
        }
    }

    fn place_paragraph(&mut self, text: &str, style: Style, width: f32) {
        let lines = self.lines(style, text, width);
        self.ensure_space(lines.len().min(2) as f32 * style.line_height());
        for line in lines {
            self.ensure_space(style.line_height());
            self.text_at(MARGIN, self.y, style, line);
            self.y += style.line_height();
        }
        self.y += 5.7;
    }

    fn place_footer(&mut self, report: &Report) {
        let labels = &report.labels;
        let lines = self.lines(LABEL, &labels.no_certificate, WIDTH).len() as f32;
        self.ensure_space(25.0 + lines * LABEL.line_height() + SIGNATURE_SPACE + 2.0 * SIGNATURE.line_height());
        self.add_space(25.0);
        self.place_paragraph(&labels.no_certificate, LABEL, WIDTH);
        self.y += SIGNATURE_SPACE;
        let count = labels.signatures.len().max(1) as f32;
        let (gap, mut x) = (22.7, MARGIN);
        let width = (WIDTH - gap * (count - 1.0)) / count;
        for label in &labels.signatures {
            self.rule(x, self.y, width, 0.6, TEXT);
            self.text_at(x, self.y + 3.0, SIGNATURE, label);
            x += width + gap;
        }
    }

    /// Adds the report number and the page number to each page.
    pub(super) fn place_page_numbers(&mut self, report: &Report) {
        let style = Style { size: 7.5, ..SIGNATURE };
        let labels = &report.labels;
        let number = format!("{} {}", labels.number, report.content_hash().report_number());
        let count = self.pages.len();
        let y = super::flow::PAGE.1 - 38.0;
        for (page, index) in (1..=count).zip(0..) {
            let text = format!("{} {page} {} {count}", labels.page, labels.of);
            let right = MARGIN + WIDTH - self.width(style, &text);
            let marks = [(MARGIN, number.clone()), (right, text)].map(|(x, text)| PageMark::Text {
                x,
                y,
                size: style.size,
                face: style.face,
                colour: style.colour,
                text,
            });
            if let Some(page) = self.pages.get_mut(index) {
                page.extend(marks);
            }
        }
    }
}

fn drawing_scale(drawing: &Drawing) -> f32 {
    DRAWING_UNIT.min(WIDTH / drawing.width.max(1) as f32)
}

fn drawing_height(drawing: &Drawing) -> f32 {
    drawing.height as f32 * drawing_scale(drawing) + 8.5
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::super::flow::END;
    use super::super::typeface::Typefaces;
    use super::*;

    #[test]
    fn splits_fact_longer_than_page() {
        let faces = Typefaces::load().unwrap();
        let mut flow = Flow::new(&faces);
        let words: Vec<String> = (0..300).map(|number| format!("line{number}")).collect();
        flow.place_fact(&Fact::new("Note", words.join("\n")));
        let texts = flow.pages.iter().flatten().filter_map(|mark| match mark {
            PageMark::Text { y, text, .. } => Some((*y, text.clone())),
            _ => None,
        });
        let (heights, texts): (Vec<f32>, Vec<String>) = texts.unzip();
        assert!(heights.iter().all(|y| *y <= END), "{heights:?}");
        let (label, lines): (Vec<_>, Vec<_>) = texts.into_iter().partition(|text| text == "Note");
        assert_eq!((label.len(), lines), (1, words));
        // A page has room for 728 points, which are 57 lines of 12.6 points.
        assert_eq!(flow.pages.len(), 6);
    }
}
