"""Pictures of one browser's view, drawn by it again."""

import io

import viser

from app.render.surroundings import before_sky

PICTURE_TIMEOUT = 60.0  # [s] for a browser to draw a picture
QUALITY = 90  # of JPEG


def take_picture(
    client: viser.ClientHandle,
    size: tuple[int, int] = (0, 0),
    *,
    transparent: bool = False,
    jpeg: bool = False,
    timeout: float = PICTURE_TIMEOUT,
) -> bytes:
    """The view of a browser as a PNG or JPEG file; without panel.

    size: width and height [pixels]; a height of 0 is that of the page's proportions, a width of 0 that of the page.
    timeout: [s] for the browser to draw it.

    Waits for the browser, so it must not be called on viser's event loop. Raises TimeoutError, and RuntimeError if the
    browser has drawn nothing.
    """
    import imageio.v3 as iio  # only where a picture is made

    camera = client.camera
    width = size[0] or camera.image_width
    picture = client.get_render(
        size[1] or round(width * camera.image_height / camera.image_width),
        width,
        transport_format="png",  # with transparency, and without loss
        timeout=timeout,
    )
    if not picture.any():
        raise RuntimeError("the browser drew an empty picture: load the page again")
    encoded = io.BytesIO()
    how = {"extension": ".jpg", "quality": QUALITY} if jpeg else {"extension": ".png"}
    iio.imwrite(encoded, picture if transparent else before_sky(client, picture), **how)  # pyright: ignore
    return encoded.getvalue()
