"""Pages are HTML of our own, in the language of whoever asks, and load nothing of a framework."""

import gzip
import posixpath
import re

import httpx
import pytest
from hypothesis import given
from hypothesis import strategies as st

from latentarm.web.server.assets import THREE, Assets
from latentarm.web.server.pages import PAGES
from latentarm.web.words.catalogue import COOKIE, DEFAULT, chosen_language, languages

PATHS = [page.path for page in PAGES]


@pytest.fixture(scope="module")
def client(site):
    with httpx.Client(base_url=site.origin) as client:
        yield client


@pytest.mark.parametrize("path", PATHS)
def test_a_page_loads_only_files_of_ours_and_runs_no_inline_script(client, path):
    answer = client.get(path)
    assert answer.status_code == 200
    assert set(re.findall(r"<script[^>]*?type=\"([^\"]*)", answer.text)) == {"application/json", "module"}
    assert "style=" not in answer.text
    assert " onclick" not in answer.text
    for address in re.findall(r'(?:href|src)="(/static/[^"]*)"', answer.text):
        assert client.get(address).status_code == 200


def test_what_a_page_loads_is_kept_for_good_and_compressed(client):
    found = client.get(Assets().path("layout/page.css"), headers={"accept-encoding": "gzip"})
    assert "immutable" in found.headers["cache-control"]
    assert found.headers["content-encoding"] == "gzip"
    again = client.get(found.request.url.path, headers={"if-none-match": found.headers["etag"]})
    assert again.status_code == 304
    plain = client.get(found.request.url.path, headers={"accept-encoding": "identity"})
    assert plain.text == found.text


def test_a_page_that_has_not_changed_is_not_sent_again(client):
    tag = client.get("/").headers["etag"]
    assert client.get("/", headers={"if-none-match": tag}).status_code == 304


@pytest.mark.parametrize("path", ["/static/0/layout/page.css", "/static/", "/static/layout/base.html"])
def test_other_files_are_not_served(client, path):
    assert client.get(path).status_code == 404


def test_templates_are_not_served(client):
    version = Assets().path(THREE).split("/")[2]
    assert client.get(f"/static/{version}/layout/base.html").status_code == 404
    assert client.get(f"/static/{version}/%2e%2e/server/app.py").status_code == 404


def modules_of(script, assets, found=None):
    """A script and everything that it imports, in time or at once."""
    found = {} if found is None else found
    if script in found:
        return found
    found[script] = assets._assets[script]
    imports = r'^(?:import|export)[ {][^"\n]*"(\.[^"]+\.js)"|await import\("(\.[^"]+\.js)"\)'
    for named in re.findall(imports, found[script].content.decode(), re.MULTILINE):
        path = posixpath.join(posixpath.dirname(script), "".join(named))
        modules_of(posixpath.normpath(path), assets, found)
    return found


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_a_page_loads_at_most_300_kb_of_script(page):
    loaded = modules_of(page.script, Assets())
    assert all(gzip.decompress(asset.compressed) == asset.content for asset in loaded.values())
    assert sum(len(asset.compressed) for asset in loaded.values()) < 300_000
    assert page.name != "drive" or {THREE, "three/three.core.min.js"} <= loaded.keys()


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_a_page_names_every_module_that_it_needs_to_work_so_that_all_come_at_once(client, page):
    named = set(re.findall(r'rel="modulepreload" href="([^"]*)"', client.get(page.path).text))
    assets = Assets()
    assert assets.path(page.script) in named
    assert assets.path(THREE) not in named
    for address in named:
        for other in re.findall(r'^[^*/]* from "(\.[^"]+\.js)";$', client.get(address).text, re.MULTILINE):
            assert posixpath.normpath(posixpath.join(posixpath.dirname(address), other)) in named


def test_three_js_keeps_its_notice(client):
    for name in (THREE, "three/three.core.min.js"):
        assert "SPDX-License-Identifier: MIT" in client.get(Assets().path(name)).text[:200]


def test_an_address_or_method_that_is_not_there_is_refused_in_json(client):
    assert client.get("/nothing").json() == {"detail": "Not Found"}
    refused = client.post("/scene.json", headers={"origin": str(client.base_url)})
    assert (refused.status_code, refused.json()) == (405, {"detail": "Method Not Allowed"})


@pytest.mark.parametrize(
    ("cookie", "accepted", "language"),
    [
        ("", "", "en"),
        ("", "fr, xx;q=0.9", "en"),
        ("", "de-AT,de;q=0.9,en;q=0.8", "de"),
        ("", "en-GB,de;q=0.9", "en"),
        ("", "en;q=0.1, de;q=0.2", "de"),
        ("", "de;q=0, en", "en"),
        ("de", "en", "de"),
        ("../en", "de", "de"),
        ("", "es-MX,es;q=0.9,en;q=0.8", "es"),
        ("", "zh-CN,zh;q=0.9,en;q=0.8", "zh"),
        ("zh", "es", "zh"),
    ],
)
def test_a_person_reads_the_language_of_their_choice(cookie, accepted, language):
    assert chosen_language(cookie, accepted).language == language


@given(st.text(), st.text())
def test_any_request_is_answered_in_some_language(cookie, accepted):
    assert chosen_language(cookie, accepted).language in languages()


def test_pages_say_which_language_they_are_in(client):
    for language in languages():
        answer = client.get("/", headers={"accept-language": language})
        assert f'<html lang="{language}" dir="ltr">' in answer.text
        assert answer.headers["content-language"] == language
    chosen = client.get("/", headers={"accept-language": "de", "cookie": f"{COOKIE}={DEFAULT}"})
    assert chosen.headers["content-language"] == DEFAULT
