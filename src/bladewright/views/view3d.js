// The view in space of notebooks and reports: triangles, lines and points drawn with a depth buffer into a canvas.
// It needs no library, no network and no graphics processor. Parallel projection and shading are those of raster.py.
(() => {
  "use strict";
  const LIGHTS = [[-0.45, 0.65, 0.60, 0.52], [0.85, 0.25, 0.45, 0.20], [0.0, 0.0, 1.0, 0.24]];
  const AMBIENT = 0.36, GLOSS = 0.16, SHARPNESS = 28, HAZE = 0.30, PANE = 0.14, INK = "#22303c";

  const scaled = (a, s) => a.map((x) => x * s);
  const sum = (a, b) => a.map((x, i) => x + b[i]);
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const unit = (a) => scaled(a, 1 / Math.sqrt(dot(a, a)));
  const lamps = LIGHTS.map(([x, y, z, strength]) => ({ at: unit([x, y, z]), strength }));
  lamps.forEach((lamp) => { lamp.half = unit(sum(lamp.at, [0, 0, 1])); });

  function numbers(text, Kind, step) {
    const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
    return Float32Array.from(new Kind(bytes.buffer), (value) => value * step);
  }

  // points of every copy: turned about x by an increase of theta, or shifted along y
  function moved(points, { turn = 0, shift = 0 }) {
    const found = Float32Array.from(points), c = Math.cos(turn), s = Math.sin(turn);
    for (let i = 0; i < found.length; i += 3) {
      const y = points[i + 1], z = points[i + 2];
      found[i + 1] = y * c + z * s + shift;
      found[i + 2] = z * c - y * s;
    }
    return found;
  }

  function unpacked(scene) {
    const grids = [], lines = [];
    for (const grid of scene.grids) {
      const points = numbers(grid.points, Int16Array, scene.step), normals = numbers(grid.normals, Int8Array, 1 / 127);
      for (const copy of grid.copies) {
        grids.push({ ...grid, points: moved(points, copy), normals: moved(normals, { turn: copy.turn }) });
      }
    }
    for (const line of scene.lines) {
      const points = numbers(line.points, Int16Array, scene.step);
      for (const copy of line.copies) lines.push({ ...line, points: moved(points, copy) });
    }
    const dots = scene.dots.map((each) => ({ ...each, points: numbers(each.points, Int16Array, scene.step) }));
    return { grids, lines, dots };
  }

  class Picture {
    constructor(width, height) {
      this.width = width;
      this.height = height;
      this.image = new ImageData(width, height);
      this.colours = new Uint32Array(this.image.data.buffer);
      this.depth = new Float32Array(width * height).fill(-Infinity);
    }

    // a triangle of the corners at i, j, k of an array of x, y, depth, light, shine and side; glass tints what is behind
    // it and hides nothing
    triangle(corners, i, j, k, shade, glass) {
      const ax = corners[i], ay = corners[i + 1], bx = corners[j] - ax, by = corners[j + 1] - ay;
      const cx = corners[k] - ax, cy = corners[k + 1] - ay, area = bx * cy - cx * by;
      if (!area) return;
      const left = Math.max(0, Math.ceil(ax + Math.min(0, bx, cx) - 0.5));
      const right = Math.min(this.width - 1, Math.floor(ax + Math.max(0, bx, cx) - 0.5));
      const top = Math.max(0, Math.ceil(ay + Math.min(0, by, cy) - 0.5));
      const bottom = Math.min(this.height - 1, Math.floor(ay + Math.max(0, by, cy) - 0.5));
      for (let y = top; y <= bottom; y++) {
        const py = y + 0.5 - ay;
        for (let x = left, at = y * this.width + left; x <= right; x++, at++) {
          const px = x + 0.5 - ax, b = (px * cy - cx * py) / area, c = (bx * py - px * by) / area, a = 1 - b - c;
          if (a < -1e-6 || b < -1e-6 || c < -1e-6) continue;
          const depth = a * corners[i + 2] + b * corners[j + 2] + c * corners[k + 2];
          if (depth <= this.depth[at]) continue;
          const light = a * corners[i + 3] + b * corners[j + 3] + c * corners[k + 3];
          const shine = a * corners[i + 4] + b * corners[j + 4] + c * corners[k + 4];
          if (!glass) this.depth[at] = depth;
          this.colours[at] = glass ? shade.over(this.colours[at], light, shine) : shade.solid(depth, light, shine);
        }
      }
    }

    line(points, seen, width, colour, bias) {
      for (let i = 3; i < points.length; i += 3) {
        const a = seen(points, i - 3), b = seen(points, i);
        const count = Math.max(1, Math.ceil(1.5 * Math.hypot(b[0] - a[0], b[1] - a[1])));
        if (count > 20000) continue;
        for (let k = 0; k <= count; k++) {
          this.square(a.map((value, j) => value + (k / count) * (b[j] - value)), width, colour, bias);
        }
      }
    }

    square(at, size, colour, bias) {
      const left = Math.round(at[0] - size / 2), top = Math.round(at[1] - size / 2);
      for (let y = Math.max(0, top); y < Math.min(this.height, top + size); y++) {
        for (let x = Math.max(0, left); x < Math.min(this.width, left + size); x++) {
          if (at[2] + bias > this.depth[y * this.width + x]) this.colours[y * this.width + x] = colour;
        }
      }
    }
  }

  const packed = (r, g, b, opacity = 255) => ((opacity << 24) | (b << 16) | (g << 8) | r) >>> 0;
  const byte = (x) => Math.max(0, Math.min(255, Math.round(255 * x)));
  const ink = (colour) => packed(...colour.map(byte));

  function shading(colour, near, far) {
    const [red, green, blue] = colour, shown = (base, light, shine) => Math.min(255, 255 * (base * light + GLOSS * shine));
    return {
      solid(depth, light, shine) {
        const haze = HAZE * Math.max(0, Math.min(1, (near - depth) / (near - far))), white = 255 * haze;
        const over = (base) => (shown(base, light, shine) * (1 - haze) + white) & 255;
        return packed(over(red), over(green), over(blue));
      },
      over(behind, light, shine) {
        const old = behind >>> 24 ? behind : 0xffffffff;
        const over = (base, bits) => (((old >>> bits) & 255) * (1 - PANE) + PANE * shown(base, light, shine)) & 255;
        return packed(over(red, 0), over(green, 8), over(blue, 16));
      },
    };
  }

  function drawn(parts, view, width, height, zoom, line) {
    const picture = new Picture(width, height), [right, up, towards] = view.axes;
    const seen = (points, i) => {
      const x = points[i] - view.centre[0], y = points[i + 1] - view.centre[1], z = points[i + 2] - view.centre[2];
      return [
        width / 2 + zoom * (right[0] * x + right[1] * y + right[2] * z),
        height / 2 - zoom * (up[0] * x + up[1] * y + up[2] * z),
        zoom * (towards[0] * x + towards[1] * y + towards[2] * z),
      ];
    };
    const reach = zoom * view.reach;
    for (const glass of [false, true]) {
      for (const grid of parts.grids) {
        if (Boolean(grid.glass) !== glass) continue;
        const shade = shading(grid.colour, reach, -reach), corners = lit(grid, seen, view.axes);
        for (let i = 0; i + 1 < grid.rows; i++) {
          for (let j = 0; j + 1 < grid.columns; j++) {
            const a = 6 * (i * grid.columns + j), b = a + 6 * grid.columns, c = b + 6, d = a + 6;
            const sides = corners[a + 5] + corners[b + 5] + corners[c + 5] + corners[d + 5];
            if (grid.side && grid.side * sides <= 0) continue;
            picture.triangle(corners, a, b, c, shade, glass);
            picture.triangle(corners, a, c, d, shade, glass);
          }
        }
      }
    }
    for (const each of parts.lines) {
      const size = Math.max(1, Math.round(each.width * line));
      picture.line(each.points, seen, size, ink(each.colour), 3 * size);
    }
    for (const each of parts.dots) {
      for (let i = 0; i < each.points.length; i += 3) {
        picture.square(seen(each.points, i), Math.round(3 * line), ink(each.colour), 3 * line);
      }
    }
    return picture;
  }

  // x, y, depth, light, shine (Blinn 1977) and side of every point of a grid
  function lit({ points, normals }, seen, [right, up, towards]) {
    const corners = new Float32Array(2 * points.length), n = [0, 0, 0];
    for (let i = 0; i < points.length; i += 3) {
      const normal = [normals[i], normals[i + 1], normals[i + 2]], side = dot(normal, towards);
      const size = (side < 0 ? -1 : 1) / (Math.sqrt(dot(normal, normal)) || 1);
      [n[0], n[1], n[2]] = [size * dot(normal, right), size * dot(normal, up), size * side];
      let light = AMBIENT, shine = 0;
      for (const lamp of lamps) {
        light += lamp.strength * Math.max(0, dot(n, lamp.at));
        shine += lamp.strength * Math.max(0, dot(n, lamp.half)) ** SHARPNESS;
      }
      corners.set([...seen(points, i), light, shine, side], 2 * i);
    }
    return corners;
  }

  // axes after the near side was turned to the right by `across` and downwards by `above`
  function turned([right, up, towards], across, above) {
    const [c, s] = [Math.cos(across), Math.sin(across)], [k, t] = [Math.cos(above), Math.sin(above)];
    const side = sum(scaled(right, c), scaled(towards, s)), front = sum(scaled(towards, c), scaled(right, -s));
    return [unit(side), unit(sum(scaled(up, k), scaled(front, -t))), unit(sum(scaled(front, k), scaled(up, t)))];
  }

  function start(place) {
    const scene = JSON.parse(place.dataset.scene), parts = unpacked(scene);
    const canvas = document.createElement("canvas"), still = place.querySelector("img");
    const pen = canvas.getContext("2d");
    if (!pen) return;
    const first = () => ({ axes: scene.axes, centre: scene.centre, reach: scene.reach, size: scene.size });
    let view = first(), queued = false, moving = false, rest = 0;
    canvas.tabIndex = 0;
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", still.alt);
    canvas.style.cssText = "display:block;width:100%;touch-action:none;cursor:grab;outline-offset:-2px";
    canvas.style.aspectRatio = `${scene.ratio}`;
    still.replaceWith(canvas);

    function draw() {
      queued = false;
      const width = canvas.clientWidth || 560, height = Math.round(width / scene.ratio);
      const pixels = window.devicePixelRatio || 1, fineness = moving ? 1 : Math.max(2, pixels);
      const [wide, high] = [Math.round(width * fineness), Math.round(height * fineness)];
      const picture = drawn(parts, view, wide, high, (wide / view.size), fineness);
      const buffer = document.createElement("canvas");
      [buffer.width, buffer.height] = [wide, high];
      buffer.getContext("2d").putImageData(picture.image, 0, 0);
      [canvas.width, canvas.height] = [Math.round(width * pixels), Math.round(height * pixels)];
      pen.scale(pixels, pixels);
      pen.fillStyle = "white";
      pen.fillRect(0, 0, width, height);
      pen.imageSmoothingQuality = "high";
      pen.drawImage(buffer, 0, 0, width, height);
      legend(width, height);
    }

    function legend(width, height) {
      pen.strokeStyle = pen.fillStyle = INK;
      pen.lineWidth = 1.5;
      pen.font = "12px sans-serif";
      pen.textAlign = "center";
      pen.textBaseline = "middle";
      "xyz".split("").forEach((name, i) => {
        const across = view.axes[0][i], above = -view.axes[1][i], [x, y] = [40, height - 42];
        pen.beginPath();
        pen.moveTo(x, y);
        pen.lineTo(x + 22 * across, y + 22 * above);
        pen.stroke();
        pen.fillText(name, x + 31 * across, y + 31 * above);
      });
      const wanted = view.size / 6, tens = 10 ** Math.floor(Math.log10(wanted));
      const bar = tens * [1, 2, 5].filter((each) => each * tens <= wanted).pop(), long = (bar / view.size) * width;
      pen.fillRect(90, height - 32, long, 2);
      pen.fillText(`${Number(bar.toPrecision(3))} ${scene.unit}`, 90 + long / 2, height - 20);
    }

    function change(turnedView) {
      view = { ...view, ...turnedView };
      moving = true;
      clearTimeout(rest);
      rest = setTimeout(() => { moving = false; draw(); }, 150);
      if (!queued) requestAnimationFrame(draw);
      queued = true;
    }
    const turn = (across, above) => change({ axes: turned(view.axes, across, above) });
    const zoom = (factor) => change({ size: Math.max(1e-3, Math.min(20, view.size / scene.size * factor)) * scene.size });
    function shift(x, y) {
      const step = view.size / canvas.clientWidth;
      change({ centre: sum(view.centre, sum(scaled(view.axes[0], -x * step), scaled(view.axes[1], y * step))) });
    }

    let held = null;
    canvas.addEventListener("pointerdown", (event) => {
      held = [event.clientX, event.clientY];
      canvas.setPointerCapture(event.pointerId);
      canvas.focus({ preventScroll: true });
      event.preventDefault();
    });
    canvas.addEventListener("pointermove", (event) => {
      if (!held) return;
      const [x, y] = [event.clientX - held[0], event.clientY - held[1]];
      held = [event.clientX, event.clientY];
      if (event.shiftKey || event.buttons === 2) shift(x, y);
      else turn(0.01 * x, 0.01 * y);
    });
    for (const name of ["pointerup", "pointercancel"]) canvas.addEventListener(name, () => { held = null; });
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    canvas.addEventListener("dblclick", () => change(first()));
    canvas.addEventListener("wheel", (event) => {
      if (document.activeElement !== canvas) return; // else the page could not be scrolled past the view
      event.preventDefault();
      zoom(Math.exp(0.001 * event.deltaY));
    }, { passive: false });
    canvas.addEventListener("keydown", (event) => {
      const keys = {
        ArrowLeft: () => turn(-0.1, 0), ArrowRight: () => turn(0.1, 0), ArrowUp: () => turn(0, -0.1),
        ArrowDown: () => turn(0, 0.1), "+": () => zoom(1 / 1.2), "-": () => zoom(1.2), Home: () => change(first()),
      };
      if (!keys[event.key]) return;
      event.preventDefault();
      keys[event.key]();
    });
    if (window.ResizeObserver) new ResizeObserver(() => { if (!queued) requestAnimationFrame(draw); queued = true; }).observe(canvas);
    draw();
  }

  for (const place of document.querySelectorAll("[data-scene]:not([data-started])")) {
    place.dataset.started = "";
    start(place);
  }
})();
