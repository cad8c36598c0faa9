//! The page of a report as its readers meet it: opened in a browser, looked at, clicked, dragged.
//!
//! Needs an adapter to make a report and a browser to open it. Where one lacks the tests say so on standard error, and
//! fail when `UMBRAGE_GOLDEN_REQUIRED=1` or `UMBRAGE_BROWSER_REQUIRED=1`.

mod browser;

use browser::{Browser, Folder, TEMPORARY};
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::io::Write;
use std::path::Path;
use std::process::Command;

fn umbrage(folder: &Path, args: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_umbrage"));
    command.current_dir(folder).args(args).env_remove("UMBRAGE_WITHOUT").env_remove("UMBRAGE_ADAPTER");
    command
}

fn has_adapter() -> bool {
    let doctor = umbrage(Path::new("."), &["doctor"]).output().expect("the command starts");
    if !doctor.status.success() {
        assert!(
            std::env::var("UMBRAGE_GOLDEN_REQUIRED").as_deref() != Ok("1"),
            "UMBRAGE_GOLDEN_REQUIRED=1, but there is no graphics adapter; `umbrage doctor` says what to install"
        );
        let _ =
            writeln!(std::io::stderr(), "\nSKIPPED: a report needs a graphics adapter, and there is none");
    }
    doctor.status.success()
}

/// A report that is open in a browser. The browser goes before the folder that it has open.
struct Report {
    browser: Browser,
    data: Value,
    folder: Folder,
}

impl Report {
    /// None where something lacks, which is said.
    fn open(name: &str, args: &[&str]) -> Option<Self> {
        let program = browser::find()?;
        if !has_adapter() {
            return None;
        }
        let folder = Folder::new(name);
        let scene = ["compare", "builtin:torus", "--frames", "1", "-o", "report"];
        let made = umbrage(&folder.0, &[&scene, args].concat()).output().expect("the command starts");
        assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
        let mut browser = Browser::start(&program, &folder.0.join("profile"));
        browser.open(&folder.0.join("report/index.html"));
        let data = browser.value("JSON.parse(document.getElementById('data').textContent)");
        Some(Self { browser, data, folder })
    }

    fn results(&self) -> Vec<Value> {
        self.data["results"].as_array().expect("results").clone()
    }

    /// Indices of the results that the table shows, in its order.
    fn rows(&mut self) -> Vec<usize> {
        let rows =
            "[...document.querySelectorAll('#results tbody tr')].map((tr) => Number(tr.dataset.index))";
        serde_json::from_value(self.browser.value(rows)).expect("indices")
    }

    /// The index of the one row that is chosen.
    #[track_caller]
    fn chosen(&mut self) -> usize {
        let rows = "[...document.querySelectorAll('#results tbody tr.chosen')].map((tr) => Number(tr.dataset.index))";
        let chosen: Vec<usize> = serde_json::from_value(self.browser.value(rows)).expect("indices");
        let [chosen] = chosen[..] else { panic!("not one row is chosen: {chosen:?}") };
        chosen
    }

    /// Fails unless the three pictures are those of a result and its view, and are drawn.
    #[track_caller]
    fn shows(&mut self, index: usize) {
        let result = self.results()[index].clone();
        let views = self.data["views"].as_array().expect("views");
        let truth = views.iter().find(|view| view["id"] == result["view"]).expect("the view of a result");
        let shown = [
            ("compare-bottom", &truth["final"]),
            ("compare-top", &result["final"]),
            ("heat", &result["heat"]),
        ];
        for (id, source) in shown.map(|(id, source)| (id, source.clone())) {
            assert!(source.is_string(), "result {index} has no picture for {id}");
            let image = format!("document.getElementById('{id}')");
            assert_eq!(self.browser.value(&format!("{image}.getAttribute('src')")), source, "{id}");
            let [width, height] = [&self.data["size"][0], &self.data["size"][1]].map(Value::to_string);
            self.browser.until(&format!(
                "{image}.complete && {image}.naturalWidth === {width} && {image}.naturalHeight === {height} \
                 && {image}.checkVisibility() && {image}.getBoundingClientRect().width > 100"
            ));
        }
    }

    /// The share of the picture's width, in percent, that is cut from the technique to show the truth.
    #[track_caller]
    fn cut_percent(&mut self) -> f64 {
        let inset = "getComputedStyle(document.getElementById('compare-top')).clipPath";
        let inset = self.browser.value(inset);
        let inset =
            inset.as_str().and_then(|text| text.strip_prefix("inset(")).unwrap_or_default().to_owned();
        let right = inset.split([' ', ')']).nth(1).and_then(|right| right.strip_suffix('%'));
        right.and_then(|right| right.parse().ok()).unwrap_or_else(|| panic!("not a share: inset({inset}"))
    }

    #[track_caller]
    fn is_quiet(&mut self) {
        assert_eq!(self.browser.noise(), [""; 0], "the page is to say nothing and to ask for nothing");
    }
}

/// Each picture of the data is a file of the report, and the browser can read it.
#[track_caller]
fn pictures_are_there(report: &mut Report) {
    let names = ["final", "visibility", "heat"];
    let results = report.results();
    let parts = report.data["views"].as_array().expect("views").iter().chain(&results);
    let sources: BTreeSet<String> = parts
        .flat_map(|part| names.iter().filter_map(|name| part[*name].as_str()))
        .map(str::to_owned)
        .collect();
    assert!(sources.len() >= 2 + 3, "there are few pictures: {sources:?}");
    for source in &sources {
        assert!(report.folder.0.join("report").join(source).is_file(), "{source} is not there");
    }
    let sizes = format!(
        "Promise.all({}.map(async (source) => {{
            const image = new Image();
            image.src = source;
            await image.decode();
            return [image.naturalWidth, image.naturalHeight];
        }}))",
        json!(sources)
    );
    let sizes = report.browser.value(&sizes);
    assert_eq!(sizes, json!(vec![&report.data["size"]; sources.len()]), "{sources:?}");
}

/// Fails unless the table stands in this order of `rmse`, by what it shows and by the data.
#[track_caller]
fn is_sorted(report: &mut Report, order: &str) {
    assert_eq!(
        report.browser.value(
            "[...document.querySelectorAll('#results th[aria-sort]:not([aria-sort=none])')]
            .map((th) => [th.dataset.key, th.getAttribute('aria-sort')])"
        ),
        json!([["rmse", order]])
    );
    let results = report.results();
    let rows = report.rows();
    let by_data: Vec<f64> = rows.iter().filter_map(|row| results[*row]["rmse"].as_f64()).collect();
    assert_eq!(by_data.len(), results.len(), "each technique has an rmse");
    let column = "document.querySelector('#results th[data-key=rmse]').cellIndex";
    let shown = format!(
        "[...document.querySelectorAll('#results tbody tr')].map((tr) => tr.cells[{column}].textContent)"
    );
    let shown: Vec<String> = serde_json::from_value(report.browser.value(&shown)).expect("texts");
    // What is not nothing never reads 0.
    let as_shown = |rmse: &f64| match *rmse {
        0.0 => "0".to_owned(),
        little if little < 0.0001 => "<0.0001".to_owned(),
        more => format!("{more:.4}"),
    };
    assert_eq!(shown, by_data.iter().map(as_shown).collect::<Vec<_>>());
    let in_order = |pair: &[f64]| if order == "ascending" { pair[0] <= pair[1] } else { pair[0] >= pair[1] };
    assert!(by_data.windows(2).all(in_order), "not {order}: {by_data:?}");
    assert!(by_data.first() != by_data.last(), "all are the same: {by_data:?}");
}

#[test]
fn a_report_shows_sorts_and_compares_what_was_measured() {
    let Some(mut report) = Report::open("one", &["--size", "320x180", "--techniques", "all"]) else { return };
    let results = report.results();
    let all: BTreeSet<usize> = (0..results.len()).collect();
    assert!(all.len() > 3, "`all` are several techniques: {all:?}");
    assert_eq!(report.rows().into_iter().collect::<BTreeSet<_>>(), all);
    assert_eq!(report.rows().len(), all.len());
    assert!(report.browser.value("document.getElementById('view')").is_null(), "there is nothing to select");
    pictures_are_there(&mut report);
    let chosen = report.chosen();
    report.shows(chosen);

    for order in ["ascending", "descending", "ascending"] {
        report.browser.click("#results th[data-key=\"rmse\"] button");
        is_sorted(&mut report, order);
    }
    assert_eq!(report.chosen(), chosen, "sorting chooses nothing");

    let other = report.rows().into_iter().find(|row| *row != chosen).expect("another row");
    report.browser.click(&format!("#results tr[data-index=\"{other}\"] td"));
    assert_eq!(report.chosen(), other);
    report.shows(other);
    assert!(results[chosen]["heat"] != results[other]["heat"], "each has a heat map of its own");

    let circles =
        "[...document.querySelectorAll('#plot circle[data-index]')].map((c) => Number(c.dataset.index))";
    let mut circles: Vec<usize> = serde_json::from_value(report.browser.value(circles)).expect("indices");
    circles.sort_unstable();
    assert_eq!(circles, all.into_iter().collect::<Vec<_>>(), "one circle for each technique");
    report.browser.press(&format!("#plot circle[data-index=\"{chosen}\"]"), "Enter", 13);
    assert_eq!(report.chosen(), chosen);
    report.shows(chosen);

    report.is_quiet();
    let picture = report.browser.picture();
    let file = Path::new(TEMPORARY).join("report.png");
    std::fs::write(&file, &picture).expect("the picture is written");
    let picture = image::load_from_memory(&picture).expect("a PNG");
    assert!(picture.width() > 1200 && picture.height() > 1200, "{}", file.display());
}

#[test]
fn the_slider_and_the_mouse_move_the_border_to_truth() {
    let args = ["--size", "160x90", "--techniques", "unshadowed,linear"];
    let Some(mut report) = Report::open("slider", &args) else { return };
    assert_eq!(report.cut_percent(), 50.0);
    for (key, code, cut_percent) in
        [("ArrowRight", 39, 49.0), ("Home", 36, 100.0), ("End", 35, 0.0), ("ArrowLeft", 37, 1.0)]
    {
        report.browser.press("#slider", key, code);
        assert_eq!(report.cut_percent(), cut_percent, "{key}");
    }
    for (shares, cut_percent) in [(&[0.25][..], 75.0), (&[0.3, 0.5, 0.8], 20.0), (&[0.9, 0.4], 60.0)] {
        report.browser.drag("#pane-compare", shares);
        let cut = report.cut_percent();
        // Browsers round the mouse to whole pixels.
        assert!((cut - cut_percent).abs() < 1.0, "dragged along {shares:?}, {cut} % are cut");
        let slider = report.browser.value("document.getElementById('slider').valueAsNumber");
        assert!(slider.as_f64().is_some_and(|slider| (slider + cut - 100.0).abs() <= 0.5), "{slider}, {cut}");
    }
    report.is_quiet();
}

#[test]
fn views_can_be_switched() {
    let lights = ["--light", "position=-3:5:4", "--light", "position=3:5:4"];
    let args = [&["--size", "160x90", "--techniques", "hard,linear"][..], &lights].concat();
    let Some(mut report) = Report::open("views", &args) else { return };
    let results = report.results();
    let views = report.data["views"].as_array().expect("views").clone();
    assert_eq!((views.len(), results.len()), (2, 4));
    let of_view = |view: &Value| -> Vec<usize> {
        (0..results.len()).filter(|index| results[*index]["view"] == view["id"]).collect()
    };
    assert_eq!(report.rows(), of_view(&views[0]));
    assert_eq!(report.browser.value("document.getElementById('view').options.length"), 2);
    pictures_are_there(&mut report);
    let texts = "document.querySelector('#results tbody').textContent";
    let before = report.browser.value(texts);
    for view in [&views[1], &views[0]] {
        // By its own events: what a key or the mouse does to a closed list differs between systems.
        report.browser.value(&format!(
            "Object.assign(document.getElementById('view'), {{ value: {} }}).dispatchEvent(new Event('change'))",
            view["id"]
        ));
        assert_eq!(report.rows(), of_view(view));
        let chosen = report.chosen();
        assert!(of_view(view).contains(&chosen), "{chosen}");
        report.shows(chosen);
        assert_eq!(
            report.browser.value(texts) == before,
            view == &views[0],
            "the table shows numbers of {view}"
        );
    }
    report.is_quiet();
}

/// The negative control: the tests above would notice a page that is not quiet.
#[test]
fn a_page_that_is_not_quiet_is_noticed() {
    let Some(program) = browser::find() else { return };
    let folder = Folder::new("noise");
    let mut browser = Browser::start(&program, &folder.0.join("profile"));
    let page = folder.0.join("page.html");
    let mut noise = |body: &str| {
        let page_text = format!("<!doctype html><title>x</title><link rel=icon href=data:,>{body}");
        std::fs::write(&page, page_text).expect("a page");
        browser.open(&page);
        browser.noise().join("\n")
    };
    assert_eq!(noise("<p>All is well"), "", "a quiet page makes no noise");
    for (body, word) in [
        (
            "<script>console.error('of no avail')</script>",
            "console.error: [{\"type\":\"string\",\"value\":\"of no avail\"",
        ),
        ("<script>console.log('a word')</script>", "console.log"),
        ("<script>none.of.these()</script>", "exception: \"Uncaught\" \"ReferenceError: none"),
        ("<script>setTimeout(() => { throw 'late' }, 50)</script>", "exception"),
        ("<script>Promise.reject(new Error('unheard'))</script>", "unheard"),
        ("<img src=none.png>", "log: \"error\""),
        ("<img src=none.png>", "not loaded: \"net::ERR_FILE_NOT_FOUND\""),
        ("<img src=http://umbrage.invalid/a.png>", "request: http://umbrage.invalid/a.png"),
        ("<link rel=stylesheet href=//umbrage.invalid/a.css>", "request: file://umbrage.invalid"),
        ("<script>fetch('http://127.0.0.1:9/')</script>", "request: http://127.0.0.1:9/"),
        ("<iframe src=../elsewhere.html></iframe>", "request: file://"),
    ] {
        let noise = noise(body);
        assert!(noise.contains(word), "`{word}` is not in the noise of `{body}`:\n{noise}");
    }
}
