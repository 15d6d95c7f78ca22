//! The fault bench as a chart: of each damage the objects that are answered rightly, wrongly, or
//! not at all.

use crate::faults::{Family, FaultReport, Tally};
use image::RgbImage;
use linestereo_sim::draw::sheet::{FAINT, GRID, INK, Sheet};
use linestereo_sim::draw::text::Align;

const WIDTH: u32 = 1280;
/// Of the bars, and of what stands above them.
const LEFT: f32 = 380.0;
const RIGHT: f32 = 1040.0;
const TOP: f32 = 70.0;
const ROW: f32 = 20.0;
/// Answered rightly, wrong, far off.
const COLOURS: [[u8; 3]; 3] = [[70, 190, 110], [255, 190, 40], [255, 45, 45]];

/// A bar for each damage, by families: its length is the share of objects that have an answer;
/// beside it the pairs that are refused.
#[must_use]
pub fn faults(report: &FaultReport) -> RgbImage {
    let families: Vec<_> = Family::ALL
        .into_iter()
        .map(|family| {
            (family, report.damages.iter().filter(|row| row.family == family).collect::<Vec<_>>())
        })
        .filter(|(_, rows)| !rows.is_empty())
        .collect();
    let lines = 2 + families.iter().map(|(_, rows)| rows.len() + 2).sum::<usize>();
    let mut sheet = Sheet::new([WIDTH, (TOP + ROW * lines as f32) as u32]);
    let keys = ["answered, within 1 px", "more than 1 px off", "more than 20 % off in depth"];
    for ((x, rgb), text) in [LEFT, LEFT + 200.0, LEFT + 390.0].into_iter().zip(COLOURS).zip(keys) {
        bar(&mut sheet, [x, x + 12.0], 16.0, rgb);
        sheet.label((x + 18.0, 14.0), Align::Left, INK, text.to_owned());
    }
    sheet.label((LEFT, 40.0), Align::Left, FAINT, "of the objects asked for".to_owned());
    sheet.label((RIGHT + 20.0, 40.0), Align::Left, FAINT, "pairs refused".to_owned());
    let mut y = TOP;
    for (family, rows) in families {
        sheet.label((20.0, y), Align::Left, INK, family.name().to_owned());
        y += ROW;
        for row in rows {
            line(&mut sheet, y, &row.damage, &row.tally);
            y += ROW;
        }
        y += ROW;
    }
    line(&mut sheet, y, "all that a pair can show", &report.shown_by_a_pair);
    sheet.into_picture()
}

fn line(sheet: &mut Sheet, y: f32, name: &str, tally: &Tally) {
    let Tally { pairs, refused, objects, answers, wrong, far_off, .. } = tally;
    sheet.label((LEFT - 12.0, y), Align::Right, FAINT, name.to_owned());
    sheet.label((RIGHT + 20.0, y), Align::Left, FAINT, format!("{refused} of {pairs}"));
    bar(sheet, [LEFT, RIGHT], y, GRID);
    let mut from = LEFT;
    for (count, rgb) in [answers - wrong, wrong - far_off, *far_off].into_iter().zip(COLOURS) {
        let to = from + (RIGHT - LEFT) * count as f32 / (*objects).max(1) as f32;
        bar(sheet, [from, to], y, rgb);
        from = to;
    }
}

fn bar(sheet: &mut Sheet, [from, to]: [f32; 2], y: f32, rgb: [u8; 3]) {
    let [top, bottom] = [y + 3.0, y + ROW - 4.0];
    if to > from {
        sheet.fill(&[(from, top), (to, top), (to, bottom), (from, bottom)], rgb, 1.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::faults::FaultRow;
    use std::collections::BTreeMap;

    #[test]
    fn a_bar_has_the_shares_of_its_answers() {
        let tally = Tally {
            pairs: 4,
            refused: 1,
            objects: 20,
            answers: 10,
            wrong: 6,
            far_off: 2,
            ..Tally::default()
        };
        let row = |family, damage: &str| FaultRow {
            family,
            damage: damage.to_owned(),
            flags: BTreeMap::new(),
            tally: tally.clone(),
        };
        let report = FaultReport {
            damages: vec![row(Family::ALL[1], "a"), row(Family::ALL[1], "b")],
            shown_by_a_pair: tally.clone(),
        };
        let picture = faults(&report);
        assert_eq!(picture.dimensions(), (WIDTH, (TOP + 6.0 * ROW) as u32));
        // A family's name, two damages, a gap, and the sum: right to 0.2, wrong to 0.4, far off to
        // 0.5 of the bar.
        let at = |share: f32, line: f32| {
            picture
                .get_pixel(
                    (LEFT + share * (RIGHT - LEFT)) as u32,
                    (TOP + (line + 0.5) * ROW) as u32,
                )
                .0
        };
        for line in [1.0, 2.0, 4.0] {
            assert_eq!([0.1, 0.3, 0.45].map(|share| at(share, line)), COLOURS);
            assert_eq!(at(0.7, line), GRID);
        }
    }
}
