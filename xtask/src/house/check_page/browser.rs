//! A headless Chromium, spoken to in its DevTools protocol over a pipe.
//!
//! With `--remote-debugging-pipe` the browser reads commands from file descriptor 3 and writes
//! replies and events to 4, each a JSON text that ends with a zero byte. A shell moves our pipes
//! there, so no port is opened and no driver is needed. Unix only.

use std::env;
use std::fs;
use std::io::{self, BufRead, BufReader, Write};
use std::path::PathBuf;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::thread;
use std::time::{Duration, Instant};

use serde_json::{Value, json};

/// Longer than any page of ours needs to load on a busy machine.
const PATIENCE: Duration = Duration::from_secs(60);

/// Why the browser is of no use.
#[derive(Debug, thiserror::Error)]
pub enum BrowserError {
    /// No browser of a known name is installed.
    #[error("no Chromium found; install one or name it in the variable CHROMIUM")]
    Missing,
    /// The browser cannot be started or spoken to.
    #[error("the browser does not listen: {0}")]
    Pipe(#[from] io::Error),
    /// The browser ended or takes longer than anyone should wait.
    #[error("the browser does not answer `{0}`")]
    Silent(String),
    /// The browser refuses a command.
    #[error("the browser refuses `{method}`: {reason}")]
    Refused {
        /// The command.
        method: String,
        /// What the browser says.
        reason: String,
    },
}

/// A running browser with one open tab.
pub(super) struct Browser {
    child: Child,
    commands: ChildStdin,
    messages: Receiver<Value>,
    events: Vec<Value>,
    sent: u64,
    session: Option<String>,
    profile: PathBuf,
}

impl Browser {
    pub(super) fn start() -> Result<Self, BrowserError> {
        let program = find().ok_or(BrowserError::Missing)?;
        let profile = new_profile();
        fs::create_dir_all(&profile)?;
        let mut child = Command::new("sh")
            .args(["-c", r#"exec "$@" 3<&0 4>&1 </dev/null >/dev/null"#, "sh"])
            .arg(program)
            .args(["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic"])
            // WebGL in software would be announced on the console of whatever page asks for it.
            .arg("--disable-software-rasterizer")
            .args(["--no-first-run", "--disable-background-networking", "--disable-sync"])
            .args(["--disable-component-update", "--hide-scrollbars", "--remote-debugging-pipe"])
            .arg(format!("--user-data-dir={}", profile.display()))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()?;
        let (Some(commands), Some(replies)) = (child.stdin.take(), child.stdout.take()) else {
            return Err(io::Error::other("its pipes are missing").into());
        };
        let messages = listen(replies);
        let (events, sent, session) = (Vec::new(), 0, None);
        let mut browser = Browser { child, commands, messages, events, sent, session, profile };
        browser.open_tab()?;
        Ok(browser)
    }

    fn open_tab(&mut self) -> Result<(), BrowserError> {
        let tab = self.call("Target.createTarget", json!({ "url": "about:blank" }))?;
        let attach = json!({ "targetId": tab["targetId"], "flatten": true });
        let attached = self.call("Target.attachToTarget", attach)?;
        self.session = attached["sessionId"].as_str().map(str::to_owned);
        for domain in ["Page", "Runtime", "Log", "Network"] {
            self.call(&format!("{domain}.enable"), json!({}))?;
        }
        Ok(())
    }

    /// Sends a command and waits for its result; events that come in between are kept.
    pub(super) fn call(&mut self, method: &str, params: Value) -> Result<Value, BrowserError> {
        self.sent += 1;
        let mut command = json!({ "id": self.sent, "method": method, "params": params });
        if let Some(session) = &self.session {
            command["sessionId"] = json!(session);
        }
        self.commands.write_all(format!("{command}\0").as_bytes())?;
        self.commands.flush()?;
        loop {
            let message = self.next(method)?;
            if message["id"] != json!(self.sent) {
                self.events.push(message);
            } else if let Some(reason) = message["error"]["message"].as_str() {
                let (method, reason) = (method.to_owned(), reason.to_owned());
                return Err(BrowserError::Refused { method, reason });
            } else {
                return Ok(message["result"].clone());
            }
        }
    }

    /// The value of an expression in the page.
    pub(super) fn evaluate(&mut self, expression: &str) -> Result<Value, BrowserError> {
        let params =
            json!({ "expression": expression, "returnByValue": true, "awaitPromise": true });
        let result = self.call("Runtime.evaluate", params)?;
        match result["exceptionDetails"]["exception"]["description"].as_str() {
            Some(reason) => {
                let (method, reason) = ("Runtime.evaluate".to_owned(), reason.to_owned());
                Err(BrowserError::Refused { method, reason })
            }
            None => Ok(result["result"]["value"].clone()),
        }
    }

    /// Waits until an event has come, which stays among the events.
    pub(super) fn wait_for(&mut self, event: &str) -> Result<(), BrowserError> {
        while !self.events.iter().any(|message| message["method"] == event) {
            let message = self.next(event)?;
            self.events.push(message);
        }
        Ok(())
    }

    /// The events so far, which are then forgotten.
    pub(super) fn take_events(&mut self) -> Vec<Value> {
        self.events.extend(self.messages.try_iter());
        std::mem::take(&mut self.events)
    }

    fn next(&self, awaited: &str) -> Result<Value, BrowserError> {
        self.messages.recv_timeout(PATIENCE).map_err(|reason| match reason {
            RecvTimeoutError::Timeout | RecvTimeoutError::Disconnected => {
                BrowserError::Silent(awaited.to_owned())
            }
        })
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        self.session = None;
        // It may have ended by itself; then there is nothing to close, kill or wait for.
        let _ = self.call("Browser.close", json!({}));
        let deadline = Instant::now() + Duration::from_secs(5);
        while matches!(self.child.try_wait(), Ok(None)) && Instant::now() < deadline {
            thread::sleep(Duration::from_millis(20));
        }
        let _ = self.child.kill();
        let _ = self.child.wait();
        let _ = fs::remove_dir_all(&self.profile);
    }
}

/// A folder of its own for each browser, also for two of the same process.
fn new_profile() -> PathBuf {
    static STARTED: AtomicU64 = AtomicU64::new(0);
    let (process, count) = (std::process::id(), STARTED.fetch_add(1, Ordering::Relaxed));
    env::temp_dir().join(format!("check-page-profile-{process}-{count}"))
}

fn find() -> Option<PathBuf> {
    if let Some(named) = env::var_os("CHROMIUM") {
        return Some(named.into());
    }
    let path = env::var_os("PATH")?;
    let names = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome"];
    let programs = names.iter().flat_map(|name| env::split_paths(&path).map(move |p| p.join(name)));
    programs.into_iter().find(|program| program.is_file())
}

/// Messages as they come, until the browser closes its end.
fn listen(replies: ChildStdout) -> Receiver<Value> {
    let (sender, receiver) = channel();
    thread::spawn(move || {
        let mut replies = BufReader::new(replies);
        let mut bytes = Vec::new();
        while replies.read_until(0, &mut bytes).is_ok_and(|count| count > 0) {
            if bytes.last() == Some(&0) {
                bytes.pop();
            }
            if let Ok(message) = serde_json::from_slice(&bytes)
                && sender.send(message).is_err()
            {
                break;
            }
            bytes.clear();
        }
    });
    receiver
}
