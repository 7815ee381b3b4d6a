"""A page of HTML, read as a browser would."""

import json
from html.parser import HTMLParser

VOID = {"br", "img", "meta", "hr", "link", "input", "col"}
"""tags without an end"""
ADDRESSES = ("src", "href", "data", "srcset", "poster", "action")


class Page(HTMLParser):
    """What a page holds; a tag that is not closed, or closed in another's place, is refused."""

    def __init__(self, text):
        super().__init__()
        self.open, self.tags, self.words, self.styles = [], [], "", ""
        self.feed(text)
        self.close()
        assert not self.open, self.open

    def handle_starttag(self, tag, attrs):
        names = [name for name, _ in attrs]
        assert len(set(names)) == len(names), f"{tag} has an attribute twice"
        self.tags.append((tag, dict(attrs)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open
        assert self.open.pop() == tag

    def handle_data(self, data):
        if "script" in self.open:
            return
        if "style" in self.open:
            self.styles += data
        else:
            self.words += data

    @property
    def loaded(self):
        """Addresses that the page names."""
        return [attrs[key] for _, attrs in self.tags for key in ADDRESSES if key in attrs]

    @property
    def scene(self):
        """What its view in space is told to draw."""
        return next(json.loads(attrs["data-scene"]) for _, attrs in self.tags if "data-scene" in attrs)
