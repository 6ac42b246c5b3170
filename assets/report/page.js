// Ties the parts of report.html together: one frame number moves the video, the map's camera and
// the cursors of the charts. Without it every part can still be read.
(() => {
  "use strict";
  const element = (id) => document.getElementById(id);
  const data = JSON.parse(element("data").textContent);
  const frames = data.frames.index.length;
  const slider = element("frame");
  const video = element("video");
  let map = null;
  let current = -1;

  function describe(i) {
    const state = data.states[data.frames.state[i]];
    const reason = data.reasons[data.frames.reason[i]];
    const pose = data.frames.pose[i];
    const place = pose
      ? `camera at ${pose.slice(0, 3).map((v) => v.toFixed(2)).join(", ")} ${data.units}`
      : "no pose";
    const words = [data.frames.index[i], reason ? `${state} (${reason})` : state,
                   `${data.frames.inliers[i]} inliers`, place];
    return words.join(" · ");
  }

  function show(i, source) {
    const next = Math.max(0, Math.min(frames - 1, i));
    if (next === current) return;
    current = next;
    slider.value = String(next);
    element("readout").textContent = describe(next);
    slider.setAttribute("aria-valuetext", `frame ${describe(next)}`);
    for (const cursor of document.querySelectorAll(".cursor")) {
      cursor.style.left = `${(100 * (next + 0.5)) / frames}%`;
    }
    if (map) map.setFrame(next);
    if (video && source !== "video" && Number.isFinite(video.duration)) {
      video.pause();
      video.currentTime = (next + 0.5) / data.fps;
    }
  }

  function loadVideo() {
    if (!video) return;
    const text = atob(element("video-data").textContent);
    const bytes = Uint8Array.from(text, (c) => c.charCodeAt(0));
    video.src = URL.createObjectURL(new Blob([bytes], { type: "video/mp4" }));
    const follow = () => {
      if (!video.seeking && !video.paused) show(Math.floor(video.currentTime * data.fps), "video");
      if (video.requestVideoFrameCallback) video.requestVideoFrameCallback(follow);
    };
    if (video.requestVideoFrameCallback) video.requestVideoFrameCallback(follow);
    else video.addEventListener("timeupdate", follow);
    video.addEventListener("seeked", () => {
      show(Math.floor(video.currentTime * data.fps), "video");
    });
  }

  function addCursors() {
    for (const plot of document.querySelectorAll("[data-cursor]")) {
      const cursor = document.createElement("i");
      cursor.className = "cursor";
      plot.append(cursor);
      const follow = (event) => {
        const box = plot.getBoundingClientRect();
        show(Math.floor(((event.clientX - box.left) / box.width) * frames), "chart");
      };
      plot.addEventListener("pointerdown", follow);
      plot.addEventListener("pointermove", (event) => {
        if (event.pointerType === "mouse" || event.buttons) follow(event);
      });
    }
  }

  function showMap() {
    const place = element("map");
    if (!window.PlanecastMap || frames === 0) return;
    try {
      map = window.PlanecastMap.show(place, data);
    } catch (reason) {
      console.info(`The drawing of the map stays: ${reason.message}`);
      return;
    }
    document.body.classList.add("has-map");
    for (const row of document.querySelectorAll("tr[data-plane]")) {
      row.addEventListener("click", () => {
        const chosen = !row.classList.contains("chosen");
        for (const other of document.querySelectorAll("tr.chosen")) other.classList.remove("chosen");
        row.classList.toggle("chosen", chosen);
        map.highlight(chosen ? Number(row.dataset.plane) : null);
      });
    }
  }

  function addCopyButtons() {
    if (!navigator.clipboard) return;
    for (const button of document.querySelectorAll("[data-copy]")) {
      button.hidden = false;
      button.addEventListener("click", async () => {
        await navigator.clipboard.writeText(element(button.dataset.copy).textContent);
        button.textContent = "Copied";
      });
    }
  }

  loadVideo();
  addCopyButtons();
  showMap();
  if (frames === 0) return;
  addCursors();
  slider.parentElement.hidden = false;
  slider.addEventListener("input", () => show(Number(slider.value), "slider"));
  show(0, "start");
})();
