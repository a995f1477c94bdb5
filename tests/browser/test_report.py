"""The report of a study as a browser shows it: opened from a file in headless Chromium, without any network.

KERF_SAMPLE_REPORT names the program that writes reports of invented figures, KERF_CHROMIUM the browser. Without either
every test is skipped by name.
"""

import json
import os
import re
import shutil
import struct
import subprocess
import xml.etree.ElementTree
import zlib

import pytest

SAMPLE = os.environ.get("KERF_SAMPLE_REPORT", "")
CHROMIUM = os.environ.get("KERF_CHROMIUM") or shutil.which("chromium") or ""
KINDS = ["full", "empty", "one", "odd", "splitting"]
pytestmark = pytest.mark.skipif(not SAMPLE or not CHROMIUM, reason="no Chromium, or no program that writes reports")

# Looks at the page from inside and leaves what it found as JSON in the element "probe".
PROBE = r"""
(() => {
  const found = {tables: document.querySelectorAll('table').length, charts: 0, texts: 0, outside: [], covered: [],
    pictures: [], wide: [], buttons: document.querySelectorAll('th button').length,
    loaded: performance.getEntriesByType('resource').map(r => r.name.slice(0, 60)).filter(n => !n.startsWith('data:')),
    page: [document.documentElement.scrollWidth, document.documentElement.clientWidth],
    background: getComputedStyle(document.body).backgroundColor, color: getComputedStyle(document.body).color};
  for (const svg of document.querySelectorAll('figure svg')) {
    found.charts += 1;
    const frame = svg.getBoundingClientRect(), texts = [...svg.querySelectorAll('text')];
    const boxes = texts.map(text => text.getBoundingClientRect());
    texts.forEach((text, i) => {
      const box = boxes[i];
      found.texts += 1;
      if (box.left < frame.left - 1 || box.right > frame.right + 1 || box.top < frame.top - 2 || box.bottom > frame.bottom + 2)
        found.outside.push(text.textContent);
      for (let k = 0; k < i; k++) {
        const other = boxes[k];
        const width = Math.min(box.right, other.right) - Math.max(box.left, other.left);
        const height = Math.min(box.bottom, other.bottom) - Math.max(box.top, other.top);
        if (width > 1 && height > 4) found.covered.push(text.textContent + ' | ' + texts[k].textContent);
      }
    });
  }
  for (const image of document.images) found.pictures.push([image.complete, image.naturalWidth, image.alt]);
  for (const part of document.querySelectorAll('h1, h2, h3, p, li, dd, code, figcaption'))
    if (part.closest('.scroll') === null && part.getBoundingClientRect().right > document.documentElement.clientWidth + 1)
      found.wide.push(part.textContent.slice(0, 60));
  const probe = document.createElement('pre');
  probe.id = 'probe';
  probe.textContent = JSON.stringify(found);
  document.body.append(probe);
})();
"""


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    folder = tmp_path_factory.mktemp("pages")
    for kind in KINDS:
        subprocess.run([SAMPLE, kind, str(folder / f"{kind}.html")], check=True, timeout=60)
    return {kind: folder / f"{kind}.html" for kind in KINDS}


@pytest.fixture(scope="module")
def profile(tmp_path_factory):
    return tmp_path_factory.mktemp("profile")


def chromium(page, profile, *arguments, width=1300, height=1000):
    """What the browser writes to standard output, and the lines of its console."""
    result = subprocess.run(
        [CHROMIUM, "--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", "--no-first-run",
         "--disable-background-networking", "--disable-component-update", "--disable-sync",
         "--host-resolver-rules=MAP * ~NOTFOUND", f"--user-data-dir={profile}", "--enable-logging=stderr", "--v=0",
         f"--window-size={width},{height}", *arguments, page.as_uri()],
        capture_output=True, timeout=120)
    assert result.returncode == 0, result.stderr[-2000:]
    log = result.stderr.decode(errors="replace")
    return result.stdout.decode(), [line for line in log.splitlines() if "CONSOLE" in line]


def probed(page, profile, script="", **size):
    """What PROBE finds in the page, after `script` ran in it; and the lines of the console."""
    copy = page.with_name("probed.html")
    text = page.read_text(encoding="utf-8")
    assert text.count("</body>") == 1
    copy.write_text(text.replace("</body>", f"<script>{script}{PROBE}</script></body>"), encoding="utf-8")
    dom, console = chromium(copy, profile, "--dump-dom", **size)
    found = re.search(r'<pre id="probe">(.*?)</pre>', dom, re.S)
    assert found, dom[-2000:]
    text = found[1].replace("&lt;", "<").replace("&gt;", ">").replace("&nbsp;", " ").replace("&amp;", "&")
    return json.loads(text), console


@pytest.fixture(scope="module")
def look(pages, profile):
    """probed() of an unchanged page, once for each width."""
    known = {}

    def at(kind, width):
        if (kind, width) not in known:
            known[kind, width] = probed(pages[kind], profile, width=width)
        return known[kind, width]
    return at


def pixels_of(path):
    """Width, height and rows of a PNG of 8 bits a channel, as Chromium writes them."""
    data = path.read_bytes()
    width, height, depth, kind = struct.unpack(">IIBB", data[16:26])
    assert depth == 8 and kind in (2, 6)
    step = 3 if kind == 2 else 4
    packed, at = b"", 8
    while at < len(data):
        size, name = struct.unpack(">I4s", data[at:at + 8])
        packed += data[at + 8:at + 8 + size] if name == b"IDAT" else b""
        at += 12 + size
    raw, rows, last = zlib.decompress(packed), [], bytearray(width * step)
    for y in range(height):
        begin = y * (width * step + 1)
        filter_type, row = raw[begin], bytearray(raw[begin + 1:begin + 1 + width * step])
        for i in range(len(row) if filter_type else 0):
            left = row[i - step] if i >= step else 0
            up, corner = last[i], last[i - step] if i >= step else 0
            if filter_type == 4:
                estimate = left + up - corner
                nearest = min((left, up, corner), key=lambda p: abs(estimate - p))
            else:
                nearest = (0, left, up, (left + up) // 2)[filter_type]
            row[i] = (row[i] + nearest) & 255
        rows.append([bytes(row[i:i + 3]) for i in range(0, len(row), step)])
        last = row
    return width, height, rows


@pytest.mark.parametrize("kind", KINDS)
def test_is_well_formed_xml_without_addresses(pages, kind):
    text = pages[kind].read_text(encoding="utf-8")
    root = xml.etree.ElementTree.fromstring(text.split("\n", 1)[1])
    assert root.tag == "html" and root.get("lang") == "en"
    for element in root.iter():
        for name, value in element.attrib.items():
            assert not name.startswith("on"), (element.tag, name)
            if name in ("src", "href"):
                assert value.startswith(("#", "data:image/png;base64,")), value[:80]
        assert element.tag not in ("link", "iframe", "object", "embed", "base", "form")
        if element.tag == "th":
            assert element.get("scope") in ("row", "col")
        if element.tag == "img":
            assert element.get("alt")
    assert len(root.findall(".//h1")) == 1
    assert [len(t.findall("caption")) for t in root.iter("table")] == [1] * len(list(root.iter("table")))


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("width", [1300, 390])
def test_opens_without_a_word_and_without_network(look, kind, width):
    found, console = look(kind, width)
    assert console == []
    assert found["loaded"] == []
    assert found["page"][0] <= found["page"][1], "the page scrolls sideways"
    assert found["wide"] == []


def test_has_all_tables_charts_and_pictures(look):
    found, _ = look("full", 1300)
    assert found["tables"] == 1 + 4 + 1 + 1  # overview, kinds of rays of scenes, sweep, growth
    assert found["charts"] == 4 * 5 + 3 + 3 + 4  # with the curve of automatic splitting of each scene
    assert found["texts"] > 800
    assert [picture[:2] for picture in found["pictures"]] == [[True, 240]] * 4
    assert all("test data" in picture[2] for picture in found["pictures"])


@pytest.mark.parametrize("kind", ["full", "one", "odd", "splitting"])
@pytest.mark.parametrize("width", [1300, 390])
def test_labels_neither_leave_charts_nor_cover_each_other(look, kind, width):
    found, _ = look(kind, width)
    assert found["texts"] > 0
    assert found["outside"] == []
    assert found["covered"] == []


def test_the_probe_notices(pages, profile):
    spoil = """
    const svg = document.querySelector('figure svg');
    for (const x of [370, 372]) {
      const text = document.createElementNS('http://www.w3.org/2000/svg', 'text');
      text.setAttribute('x', x); text.setAttribute('y', 30); text.textContent = 'much too long'; svg.append(text);
    }
    document.querySelector('h1').style.width = '3000px';
    console.error('a fault');
    """
    found, console = probed(pages["one"], profile, script=spoil)
    assert found["outside"] == ["much too long"] * 2
    assert found["covered"] == ["much too long | much too long"]
    assert found["page"][0] > found["page"][1] and found["wide"]
    assert len(console) == 1


def test_nothing_can_be_fetched(pages, profile):
    fetch = "const i = new Image(); i.src = 'http://127.0.0.1:9/x.png'; document.body.append(i);"
    _, console = probed(pages["one"], profile, script=fetch)
    assert any("Content Security Policy" in line for line in console)


def test_tables_are_sorted_by_a_click(pages, profile, tmp_path):
    sort = """
    const table = document.querySelector('#scene-1 table');
    const order = () => [...table.tBodies[0].rows].map(row => Number(row.dataset.row));
    const numbers = column => [...table.tBodies[0].rows].map(row => row.cells[column]).filter(cell => cell && cell.dataset.v)
      .map(cell => Number(cell.dataset.v));
    const button = table.querySelectorAll('thead button')[5], results = [order()];
    button.click(); results.push(order(), numbers(5), table.querySelectorAll('th')[5].getAttribute('aria-sort'));
    button.click(); results.push(order(), numbers(5), table.querySelectorAll('th')[5].getAttribute('aria-sort'));
    table.querySelector('thead button').click(); results.push(order());
    document.body.dataset.sorted = JSON.stringify(results);
    """
    copy = tmp_path / "sorted.html"
    copy.write_text(pages["full"].read_text(encoding="utf-8").replace("</body>", f"<script>{sort}</script></body>"),
                    encoding="utf-8")
    dom, console = chromium(copy, profile, "--dump-dom")
    assert console == []
    before, up, up_times, up_word, down, down_times, down_word, back = json.loads(
        re.search(r'data-sorted="([^"]*)"', dom)[1].replace("&quot;", '"'))
    assert before == back == list(range(1, 15))
    assert up_times == sorted(up_times) and len(up_times) == 13
    assert down_times == sorted(up_times, reverse=True)
    assert up[-1] == down[-1] == 14, "what did not finish stays last"
    assert (up_word, down_word) == ("ascending", "descending")


def test_is_whole_without_a_script(pages, profile, tmp_path):
    page = tmp_path / "still.html"
    text = pages["full"].read_text(encoding="utf-8")
    page.write_text(text[:text.index("<script>")] + text[text.index("</script>") + 9:], encoding="utf-8")
    found, _ = probed(page, profile)
    assert (found["tables"], found["charts"], found["buttons"]) == (7, 30, 0)


@pytest.mark.parametrize("dark", [False, True])
@pytest.mark.parametrize("width", [900, 390])
def test_is_seen(pages, profile, tmp_path, dark, width):
    picture = tmp_path / "page.png"
    scheme = [f"--blink-settings=preferredColorScheme={0 if dark else 1}"]
    chromium(pages["full"], profile, f"--screenshot={picture}", *scheme, width=width, height=600)
    found_width, height, rows = pixels_of(picture)
    assert (found_width, height) == (width, 600)
    background = rows[2][2]
    assert (sum(background) < 150) == dark, background
    other = sum(pixel != background for row in rows for pixel in row)
    assert 0.03 < other / (width * height) < 0.7, "blank, or covered"
    assert len({pixel for row in rows for pixel in row}) > 50


def luminance(color):
    channels = [int(color[i:i + 2], 16) / 255 for i in (1, 3, 5)]
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in channels]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def contrast(a, b):
    light, dark = sorted([luminance(a), luminance(b)], reverse=True)
    return (light + 0.05) / (dark + 0.05)


def test_colors_stand_out_in_both_modes(pages):
    """The bounds of WCAG 2.1 AA: 4.5 for text, 3 for parts of charts."""
    style = re.search(r"<style>(.*?)</style>", pages["empty"].read_text(encoding="utf-8"), re.S)[1]
    modes = [dict(re.findall(r"--([a-z0-9-]+): (#[0-9a-f]{6})", part)) for part in re.findall(r":root \{(.*?)\}", style, re.S)]
    assert len(modes) == 2
    for mode in modes:
        for text in ("text", "soft", "accent", "paper-ink", "warn"):
            for page in ("page", "panel"):
                assert contrast(mode[text], mode[page]) >= 4.5, (text, page)
        for shade in ("up1", "up2", "up3", "down1", "down2"):
            assert contrast(mode["text"], mode[shade]) >= 4.5, shade
        assert contrast(mode["warn"], mode["warn-page"]) >= 4.5
        for part in ["bar", "first", *(f"c{i}" for i in range(8))]:
            assert contrast(mode[part], mode["page"]) >= 3, part


def test_prints(pages, profile, tmp_path):
    paper = tmp_path / "page.pdf"
    _, console = chromium(pages["full"], profile, f"--print-to-pdf={paper}", "--no-pdf-header-footer")
    assert console == []
    data = paper.read_bytes()
    assert data.startswith(b"%PDF") and len(re.findall(rb"/Type\s*/Page\b", data)) >= 4
