//! A headless Chromium with one tab, driven through its DevTools protocol, and all that the tab says while it is open.
//!
//! Looked for in the path, or where `UMBRAGE_BROWSER` says. It reaches no network. Whatever goes wrong panics with a
//! line that says what: this is part of tests.
#![allow(dead_code)]

mod folder;

pub use folder::{Folder, TEMPORARY};

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use serde_json::{Value, json};
use std::ffi::OsString;
use std::io::{ErrorKind, Write};
use std::net::TcpStream;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};
use tungstenite::{Message, WebSocket};

/// `cargo xtask` looks for the same names before it lets the tests run; a test there compares.
const NAMES: [&str; 3] = ["chromium", "chromium-browser", "google-chrome"];

/// For anything that the browser is to do, on a slow machine too.
const WAIT: Duration = Duration::from_secs(30);

/// The first three keep it quick and alone in a container; the others keep it off the network, and quiet.
const FLAGS: [&str; 14] = [
    "--headless",
    "--no-sandbox",
    "--disable-dev-shm-usage",
    "--disable-quic",
    "--host-resolver-rules=MAP * ~NOTFOUND",
    "--no-proxy-server",
    "--no-first-run",
    "--no-default-browser-check",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--disable-breakpad",
    "--remote-debugging-port=0",
    "about:blank",
];

/// For pages that draw nothing of their own.
const WITHOUT_GPU: [&str; 1] = ["--disable-gpu"];

/// WebGPU by the browser's own software rasteriser, the same on every machine. The last three are for the canvas: without them
/// it has no texture that WebGPU can draw into.
const WITH_WEBGPU: [&str; 5] = [
    "--enable-unsafe-webgpu",
    "--use-webgpu-adapter=swiftshader",
    "--enable-features=Vulkan",
    "--use-vulkan=swiftshader",
    "--use-angle=swiftshader",
];

/// Two browsers on two cores wait for one another.
static ONE_AT_A_TIME: Mutex<()> = Mutex::new(());

/// The program of a browser. Where there is none says so, past the test's captured output: a skip is not a pass.
pub fn find() -> Option<PathBuf> {
    let named = std::env::var_os("UMBRAGE_BROWSER").filter(|name| !name.is_empty());
    let usual = NAMES.map(|name| OsString::from(format!("{name}{}", std::env::consts::EXE_SUFFIX)));
    let names = named.map_or_else(|| usual.to_vec(), |name| vec![name]);
    let folders = std::env::var_os("PATH").unwrap_or_default();
    let folders: Vec<PathBuf> = std::env::split_paths(&folders).collect();
    // A whole path stays itself when it is joined to a folder.
    let files = names.iter().flat_map(|name| folders.iter().map(move |folder| folder.join(name)));
    let found = files.into_iter().find(|file| file.is_file());
    if found.is_none() {
        skip(&format!("no browser is installed: {names:?} are not in the path"));
    }
    found
}

/// Says that a test is left out, and fails where it must not be.
fn skip(lacks: &str) {
    assert!(
        std::env::var("UMBRAGE_BROWSER_REQUIRED").as_deref() != Ok("1"),
        "UMBRAGE_BROWSER_REQUIRED=1, but {lacks}; install Chromium, or name one in UMBRAGE_BROWSER"
    );
    let test = std::thread::current().name().unwrap_or_default().to_owned();
    let _ = writeln!(std::io::stderr(), "\nSKIPPED: {test}: {lacks}");
}

/// The address of a file.
pub fn address(file: &Path) -> String {
    let text = file.to_string_lossy().replace('\\', "/");
    let mut address = String::from(if text.starts_with('/') { "file://" } else { "file:///" });
    for byte in text.bytes() {
        match byte {
            b'0'..=b'9' | b'A'..=b'Z' | b'a'..=b'z' | b'/' | b':' | b'-' | b'.' | b'_' | b'~' => {
                address.push(byte.into());
            }
            _ => address.push_str(&format!("%{byte:02X}")),
        }
    }
    address
}

/// A running browser. It ends when this goes.
pub struct Browser {
    process: Child,
    socket: WebSocket<TcpStream>,
    /// Of the tab; without one, commands are for the browser itself.
    session: Option<String>,
    last_id: u64,
    /// Navigations whose page is loaded.
    loaded: Vec<Value>,
    /// Requests from anywhere but here are noise.
    home: String,
    noise: Vec<String>,
    _alone: MutexGuard<'static, ()>,
}

impl Browser {
    /// `profile` is a folder for it alone, made here.
    pub fn start(program: &Path, profile: &Path) -> Self {
        Self::start_flagged(program, profile, &WITHOUT_GPU)
    }

    /// The same with WebGPU, and `page` open. None where the browser has no adapter for it, which is said.
    pub fn start_with_webgpu(program: &Path, profile: &Path, page: &Path) -> Option<Self> {
        let mut browser = Self::start_flagged(program, profile, &WITH_WEBGPU);
        browser.open(page);
        let adapter = browser.value("(async () => Boolean(await navigator.gpu?.requestAdapter()))()")
            == Value::Bool(true);
        if !adapter {
            skip(&format!("{} has no WebGPU adapter", program.display()));
        }
        adapter.then_some(browser)
    }

    fn start_flagged(program: &Path, profile: &Path, more: &[&str]) -> Self {
        let alone = ONE_AT_A_TIME.lock().unwrap_or_else(PoisonError::into_inner);
        std::fs::create_dir_all(profile).expect("a folder for the profile");
        let said = profile.join("said.txt");
        let mut data = OsString::from("--user-data-dir=");
        data.push(profile);
        let mut process = Command::new(program)
            .arg(data)
            .args(more)
            .args(FLAGS)
            // Or it keeps a folder for crashes in the user's home.
            .env("XDG_CONFIG_HOME", profile)
            .env("XDG_CACHE_HOME", profile)
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(std::fs::File::create(&said).expect("a file for what it says"))
            .spawn()
            .unwrap_or_else(|e| panic!("{} does not start: {e}", program.display()));
        let socket = connect(&mut process, profile).unwrap_or_else(|why| {
            let _ = process.kill();
            let _ = process.wait();
            let said = std::fs::read_to_string(&said).unwrap_or_default();
            let said = said.lines().rev().find(|line| !line.trim().is_empty()).unwrap_or("nothing");
            panic!("{} gives no DevTools: {why}; it said: {said}", program.display())
        });
        let mut browser = Self {
            process,
            socket,
            session: None,
            last_id: 0,
            loaded: Vec::new(),
            home: String::new(),
            noise: Vec::new(),
            _alone: alone,
        };
        browser.attach();
        browser
    }

    /// Makes the tab, as large as a usual window, and listens to all that it says.
    fn attach(&mut self) {
        let target = self.call("Target.createTarget", json!({"url": "about:blank"}));
        let target = json!({"targetId": target["targetId"], "flatten": true});
        let session = self.call("Target.attachToTarget", target);
        self.session = session["sessionId"].as_str().map(str::to_owned);
        assert!(self.session.is_some(), "the browser gives no session: {session}");
        for domain in ["Runtime", "Log", "Page", "Network", "Inspector"] {
            self.call(&format!("{domain}.enable"), json!({}));
        }
        self.call("Page.setLifecycleEventsEnabled", json!({"enabled": true}));
        // Else nothing in a window that nobody looks at has the focus.
        self.call("Emulation.setFocusEmulationEnabled", json!({"enabled": true}));
        let window = json!({"width": 1280, "height": 900, "deviceScaleFactor": 1, "mobile": false});
        self.call("Emulation.setDeviceMetricsOverride", window);
    }

    /// Opens a page and waits until it is loaded. What earlier ones said is forgotten.
    pub fn open(&mut self, page: &Path) {
        self.noise.clear();
        self.home = address(page.parent().expect("a folder")) + "/";
        let url = address(page);
        let answer = self.call("Page.navigate", json!({"url": url}));
        assert!(answer.get("errorText").is_none(), "{url} does not open: {answer}");
        let loader = &answer["loaderId"];
        let deadline = Instant::now() + WAIT;
        while !self.loaded.contains(loader) {
            assert!(Instant::now() < deadline, "{url} is not loaded after {} s", WAIT.as_secs());
            self.listen();
        }
    }

    /// What an expression of the page's own language is worth; promises are waited for.
    #[track_caller]
    pub fn value(&mut self, expression: &str) -> Value {
        let question = json!({"expression": expression, "returnByValue": true, "awaitPromise": true});
        let mut answer = self.call("Runtime.evaluate", question);
        if let Some(fault) = answer.get("exceptionDetails") {
            let what = fault["exception"]["description"].as_str().unwrap_or("no reason given");
            panic!("the page cannot tell `{expression}`: {what}");
        }
        answer["result"]["value"].take()
    }

    /// Waits until an expression is true.
    #[track_caller]
    pub fn until(&mut self, expression: &str) {
        let deadline = Instant::now() + WAIT;
        loop {
            let value = self.value(expression);
            if value == Value::Bool(true) {
                return;
            }
            let seconds = WAIT.as_secs();
            assert!(Instant::now() < deadline, "after {seconds} s `{expression}` is still {value}");
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    /// Presses the left button of the mouse on the middle of what a selector finds.
    #[track_caller]
    pub fn click(&mut self, selector: &str) {
        self.drag(selector, &[0.5]);
    }

    /// Presses the left button there, at a share of its width, moves to the others, and lets go.
    #[track_caller]
    pub fn drag(&mut self, selector: &str, shares: &[f64]) {
        let [left, top, width, height] = self.bring_into_view(selector);
        let at = |share: &f64| (left + width * share, top + height / 2.0);
        let first = at(shares.first().expect("a place"));
        let last = shares.iter().map(at).fold(first, |_, place| place);
        self.mouse("mouseMoved", first, 0);
        self.mouse("mousePressed", first, 1);
        for place in shares.iter().skip(1).map(at) {
            self.mouse("mouseMoved", place, 1);
        }
        self.mouse("mouseReleased", last, 0);
    }

    fn mouse(&mut self, event: &str, (x, y): (f64, f64), buttons: u8) {
        let button = if event == "mouseMoved" && buttons == 0 { "none" } else { "left" };
        let event =
            json!({"type": event, "x": x, "y": y, "button": button, "buttons": buttons, "clickCount": 1});
        self.call("Input.dispatchMouseEvent", event);
    }

    /// Left, top, width and height in the window. What hides its middle from the mouse is a fault of the page.
    #[track_caller]
    fn bring_into_view(&mut self, selector: &str) -> [f64; 4] {
        let expression = format!(
            "(async () => {{
                const node = document.querySelector({});
                if (!node) return 'is not there';
                node.scrollIntoView({{ block: 'center', inline: 'center', behavior: 'instant' }});
                for (let before = '';;) {{
                    await new Promise(requestAnimationFrame);
                    const {{ x, y, width, height }} = node.getBoundingClientRect(), box = [x, y, width, height];
                    if (String(box) !== before) {{ before = String(box); continue; }}
                    const hit = document.elementFromPoint(x + width / 2, y + height / 2);
                    return node.contains(hit) ? box : `is hidden by ${{hit && hit.outerHTML.slice(0, 80)}}`;
                }}
            }})()",
            json!(selector)
        );
        let found = self.value(&expression);
        serde_json::from_value(found.clone()).unwrap_or_else(|_| panic!("`{selector}` {found}"))
    }

    /// Gives the focus to what a selector finds and presses one key there: its name, and the code Windows has for it.
    #[track_caller]
    pub fn press(&mut self, selector: &str, key: &str, code: u32) {
        self.value(&format!("document.querySelector({}).focus()", json!(selector)));
        self.until(&format!("document.activeElement === document.querySelector({})", json!(selector)));
        for event in ["rawKeyDown", "keyUp"] {
            let event = json!({"type": event, "key": key, "code": key, "windowsVirtualKeyCode": code});
            self.call("Input.dispatchKeyEvent", event);
        }
    }

    /// A picture of the whole page, as PNG.
    pub fn picture(&mut self) -> Vec<u8> {
        let size = self.call("Page.getLayoutMetrics", json!({}))["cssContentSize"].take();
        let clip = json!({"x": 0, "y": 0, "width": size["width"], "height": size["height"], "scale": 1});
        let how = json!({"format": "png", "captureBeyondViewport": true, "clip": clip});
        let answer = self.call("Page.captureScreenshot", how);
        BASE64_STANDARD.decode(answer["data"].as_str().unwrap_or_default()).expect("base64")
    }

    /// What the page has said or asked for since it was opened and should not have.
    pub fn noise(&mut self) -> &[String] {
        // The page's own work is done first, and its last words may still be on their way.
        self.value("new Promise((done) => requestAnimationFrame(() => setTimeout(done, 200)))");
        self.value("0");
        &self.noise
    }

    /// Sends a command and waits for its answer.
    fn call(&mut self, method: &str, parameters: Value) -> Value {
        self.last_id += 1;
        let mut command = json!({"id": self.last_id, "method": method, "params": parameters});
        if let Some(session) = &self.session {
            command["sessionId"] = json!(session);
        }
        let sent = self.socket.send(Message::text(command.to_string()));
        sent.unwrap_or_else(|e| panic!("the browser does not take {method}: {e}"));
        let deadline = Instant::now() + WAIT;
        loop {
            assert!(
                Instant::now() < deadline,
                "no answer to {method} after {} s: {parameters}",
                WAIT.as_secs()
            );
            if let Some(mut answer) = self.listen().filter(|answer| answer["id"] == self.last_id) {
                assert!(answer.get("error").is_none(), "{method} fails: {} ({parameters})", answer["error"]);
                return answer["result"].take();
            }
        }
    }

    /// The next message, if one comes soon.
    fn listen(&mut self) -> Option<Value> {
        let message = match self.socket.read() {
            Ok(message) => message,
            Err(tungstenite::Error::Io(e))
                if matches!(e.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) =>
            {
                return None;
            }
            Err(e) => panic!("the browser is gone: {e}"),
        };
        let Message::Text(text) = message else { return None };
        let message: Value = serde_json::from_str(&text).expect("the protocol is JSON");
        self.note(&message);
        Some(message)
    }

    /// Keeps what an event says that no page should say.
    fn note(&mut self, event: &Value) {
        let about = &event["params"];
        match event["method"].as_str().unwrap_or_default() {
            "Page.lifecycleEvent" if about["name"] == "load" => self.loaded.push(about["loaderId"].clone()),
            "Runtime.consoleAPICalled" => {
                let kind = about["type"].as_str().unwrap_or_default();
                self.noise.push(format!("console.{kind}: {}", about["args"]));
            }
            "Runtime.exceptionThrown" => {
                let fault = &about["exceptionDetails"];
                self.noise
                    .push(format!("exception: {} {}", fault["text"], fault["exception"]["description"]));
            }
            "Log.entryAdded" if matches!(about["entry"]["level"].as_str(), Some("warning" | "error")) => {
                let entry = &about["entry"];
                self.noise.push(format!("log: {}: {} {}", entry["level"], entry["text"], entry["url"]));
            }
            "Network.requestWillBeSent" => {
                let url = about["request"]["url"].as_str().unwrap_or_default();
                if !url.starts_with("data:") && !url.starts_with(&self.home) {
                    self.noise.push(format!("request: {url}"));
                }
            }
            "Network.loadingFailed" => self.noise.push(format!("not loaded: {}", about["errorText"])),
            "Inspector.targetCrashed" => panic!("the page has crashed"),
            _ => {}
        }
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        // Asked, it takes its helpers with it and lets go of the profile. It is not waited for without end.
        let close = json!({"id": 0, "method": "Browser.close"});
        let _ = self.socket.send(Message::text(close.to_string()));
        let deadline = Instant::now() + Duration::from_secs(5);
        while matches!(self.process.try_wait(), Ok(None)) && Instant::now() < deadline {
            std::thread::sleep(Duration::from_millis(20));
        }
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// Waits until the browser has written where it listens, and connects.
fn connect(process: &mut Child, profile: &Path) -> Result<WebSocket<TcpStream>, String> {
    let deadline = Instant::now() + WAIT;
    let (port, path) = loop {
        let text = std::fs::read_to_string(profile.join("DevToolsActivePort")).unwrap_or_default();
        // Both lines, or it is still being written.
        if let Some((port, path)) = text.split_once('\n').filter(|(_, path)| path.len() > 20) {
            break (port.to_owned(), path.trim().to_owned());
        }
        if let Ok(Some(status)) = process.try_wait() {
            return Err(format!("it ended at once ({status})"));
        }
        if Instant::now() > deadline {
            return Err(format!("it still starts after {} s", WAIT.as_secs()));
        }
        std::thread::sleep(Duration::from_millis(20));
    };
    let stream = TcpStream::connect(format!("127.0.0.1:{port}")).map_err(|e| e.to_string())?;
    let again = stream.try_clone().map_err(|e| e.to_string())?;
    let timeout = |limit| again.set_read_timeout(Some(limit)).map_err(|e| e.to_string());
    stream
        .set_nodelay(true)
        .and_then(|()| stream.set_write_timeout(Some(WAIT)))
        .map_err(|e| e.to_string())?;
    timeout(WAIT)?;
    let address = format!("ws://127.0.0.1:{port}{path}");
    let (socket, _) = tungstenite::client(address, stream).map_err(|e| e.to_string())?;
    // Short, so that deadlines are looked at while nothing comes.
    timeout(Duration::from_millis(50))?;
    Ok(socket)
}
