"""What a browser without a window shows of the live view's page, as a program: address -> JSON.

In a process of its own: a Chromium that does not answer can be waited for without an end, and is
then killed together with what drives it.
"""

import json
import shutil
import sys
from typing import Any

from playwright.sync_api import Error, sync_playwright

NO_BROWSER = 5  # the exit code where no Chromium starts
CLICK_PX = (30, 20)
_DRAWN = "document.getElementById('curve').getContext('2d').getImageData(0, 0, 400, 200).data"


def main() -> None:
    """Open the page, click into the left eye's image, and print what there was to see."""
    with sync_playwright() as started:
        try:
            browser = started.chromium.launch(
                executable_path=shutil.which("chromium"),
                args=["--no-sandbox", "--disable-dev-shm-usage", "--disable-gpu"],
            )
        except Error as error:
            print(f"no Chromium starts here: {error}", file=sys.stderr)
            sys.exit(NO_BROWSER)
        page = browser.new_page()
        page.goto(sys.argv[1])
        print(json.dumps(_seen(page)))
        browser.close()


def _seen(page: Any) -> dict[str, Any]:
    page.wait_for_function("document.getElementById('status').textContent.startsWith('after')")
    seen = {"run": page.inner_text("#run"), "status": page.inner_text("#status")}
    for name in ("left", "right", "anaglyph"):
        page.wait_for_function(f"document.getElementById('{name}').naturalWidth == 320")
    seen["curve is drawn"] = page.evaluate(f"{_DRAWN}.some((value) => value > 0)")
    seen["mark is hidden"] = page.locator("#mark").is_hidden()
    page.click("#left", position=dict(zip("xy", CLICK_PX, strict=True)))
    page.wait_for_function("!document.getElementById('mark').hidden")
    mark, left = (page.locator(name).bounding_box() for name in ("#mark", "#left"))
    seen["centre of mark"] = [
        mark[a] + mark[b] / 2.0 - left[a] for a, b in (("x", "width"), ("y", "height"))
    ]
    return seen


if __name__ == "__main__":
    main()
