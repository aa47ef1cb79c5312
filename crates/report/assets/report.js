"use strict";
// Draws the plots of a report. Their numbers stand in the page as JSON; texts are escaped wherever they become markup.
(() => {
  const specs = JSON.parse(document.getElementById("plots").textContent);
  const dark = window.matchMedia("(prefers-color-scheme: dark)");
  let printing = false;

  // Hues that stay apart under the common colour-vision deficiencies (after Okabe and Ito), lighter on dark ground.
  const LIGHT = {
    ground: "#ffffff", ink: "#1b1f24", quiet: "#57606a", rule: "#d5dae0", fine: "#eceff2", shade: "rgba(90,100,115,0.14)",
    series: ["#0067a9", "#d55e00", "#008560", "#b0558a", "#b98200", "#3a9bd6", "#5a5f66"],
    scale: ["#440154", "#414487", "#2a788e", "#22a884", "#7ad151"],
    sides: ["#b35806", "#f1a340", "#f4f4f4", "#67a9cf", "#2166ac"],
  };
  const DARK = {
    ground: "#14171b", ink: "#e7eaee", quiet: "#a3acb7", rule: "#4a525d", fine: "#272c33", shade: "rgba(170,185,205,0.16)",
    series: ["#5db2f0", "#ff8c4a", "#35c79b", "#e29ac4", "#f0b93a", "#a5dbf9", "#b4bac2"],
    scale: ["#6d7fd6", "#3f9fc4", "#2fc0a0", "#8ad85a", "#fde725"],
    sides: ["#ffab5e", "#a8672a", "#262a30", "#3673a5", "#7cc0f5"],
  };
  const theme = () => (dark.matches && !printing ? DARK : LIGHT);

  // ---- texts -------------------------------------------------------------------------------------------------------
  const escape = (text) =>
    String(text).replace(/[&<>"']/g, (c) => ({ "&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;", "'": "&#39;" })[c]);
  const number = (value, digits = 5) => {
    if (value === null || value === undefined || !Number.isFinite(+value)) return "–";
    if (+value === 0) return "0";
    const size = Math.floor(Math.log10(Math.abs(value)));
    let text;
    if (size < -5 || size > 9) {
      const [mantissa, power] = Number(value).toExponential(digits - 2).split("e");
      const raised = String(+power).replace(/./g, (c) => "⁰¹²³⁴⁵⁶⁷⁸⁹"[c] ?? "⁻");
      text = `${+mantissa} × 10${raised}`;
    } else {
      text = String(+Number(value).toFixed(Math.max(0, Math.min(12, digits - 1 - size))));
      const [whole, part] = text.split(".");
      if (whole.replace("-", "").length > 4) {
        text = whole.replace(/\B(?=(\d{3})+$)/g, "\u202f") + (part ? "." + part : "");
      }
    }
    return text.replace(/^-/, "−");
  };
  const unit = (axis) => (axis.unit ? "\u00a0" + axis.unit : "");
  const titled = (axis) => (axis.unit ? `${axis.label} [${axis.unit}]` : axis.label);
  const row = (colour, name, value) =>
    `<div style="display:flex;gap:1em;justify-content:space-between"><span><span style="color:${colour}">●</span> ` +
    `${escape(name)}</span><b>${escape(value)}</b></div>`;

  // ---- numbers -----------------------------------------------------------------------------------------------------
  /** Index of the entry of ascending `values` that is nearest to `at`; -1 if there is none. */
  const nearest = (values, at) => {
    let low = 0;
    let high = values.length - 1;
    if (high < 0) return -1;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (values[middle] <= at) low = middle;
      else high = middle;
    }
    return Math.abs(values[high] - at) < Math.abs(values[low] - at) ? high : low;
  };
  const finite = (values) => values.filter((value) => value !== null);
  const range = (values) => values.reduce(([l, h], v) => (v === null ? [l, h] : [Math.min(l, v), Math.max(h, v)]), [Infinity, -Infinity]);
  /** Ends of an axis on round numbers around `low` and `high`. */
  const rounded = (low, high) => {
    const step = stride(low, high);
    return [Math.floor(low / step) * step, Math.ceil(high / step) * step].map((end) => +end.toPrecision(12));
  };
  /** Distance of about five round numbers between `low` and `high`. */
  const stride = (low, high) => {
    const width = high - low || Math.abs(high) || 1;
    const rough = width / 5;
    const power = 10 ** Math.floor(Math.log10(rough));
    return power * [1, 2, 5, 10].find((factor) => factor * power >= rough * 0.999999);
  };
  const pairs = (x, y) => x.map((at, index) => [at, y[index]]);
  /** Pieces of consecutive indices at which none of the arrays has a gap. */
  const pieces = (...arrays) => {
    const found = [];
    let current = [];
    for (let index = 0; index <= arrays[0].length; index++) {
      if (index < arrays[0].length && arrays.every((array) => array[index] !== null)) current.push(index);
      else if (current.length) {
        found.push(current);
        current = [];
      }
    }
    return found;
  };

  // ---- parts of plots ----------------------------------------------------------------------------------------------
  const base = (t) => ({
    animation: false,
    backgroundColor: t.ground,
    color: t.series,
    textStyle: { color: t.ink, fontFamily: "system-ui, -apple-system, 'Segoe UI', Roboto, Arial, sans-serif" },
    tooltip: {
      confine: true, backgroundColor: t.ground, borderColor: t.rule, padding: [6, 10],
      textStyle: { color: t.ink, fontSize: 12 }, extraCssText: "max-width:22rem;white-space:normal",
    },
  });
  const axisStyle = (t) => ({
    axisLabel: { color: t.quiet, fontSize: 11, hideOverlap: true, formatter: (value) => number(value, 6) },
    axisLine: { show: true, onZero: false, lineStyle: { color: t.rule } },
    axisTick: { show: true, lineStyle: { color: t.rule } },
    splitLine: { show: true, lineStyle: { color: t.fine } },
    nameTextStyle: { color: t.quiet, fontSize: 12 },
  });
  /** Given ends, moved out to round numbers where these are near: 600 and not 599.99. */
  const ends = ({ from, to }) => {
    if (from === undefined) return {};
    const [low, high] = rounded(from, to);
    const near = 0.02 * (to - from);
    return { min: from - low <= near ? low : from, max: high - to <= near ? high : to };
  };
  /** Which ends of an axis get a label: not those that are no round numbers. */
  const labelled = (axis) => {
    const { min, max } = ends(axis);
    if (min === undefined) return { showMinLabel: null, showMaxLabel: null };
    const [low, high] = rounded(min, max);
    return { showMinLabel: low === min ? null : false, showMaxLabel: high === max ? null : false };
  };
  const across = (axis, t) => ({
    type: "value", scale: true, name: titled(axis), nameLocation: "middle", nameGap: 26, ...ends(axis), ...axisStyle(t), splitLine: { show: false },
    axisLabel: { ...axisStyle(t).axisLabel, ...labelled(axis) },
  });
  const upward = (t) => ({ type: "value", scale: true, splitNumber: 4, ...axisStyle(t) });
  /** A line at zero, where there is something on both sides of it. */
  const zero = ([low, high], t) =>
    low < 0 && high > 0 ? [{ yAxis: 0, label: { show: false }, lineStyle: { color: t.quiet, type: "solid", width: 0.8, opacity: 0.7 } }] : [];
  /** The label of the vertical axis lies above it: read without turning one's head. */
  const heading = (text, t) => ({ text, left: 0, top: 2, padding: 0, textStyle: { color: t.quiet, fontSize: 12, fontWeight: "normal" } });
  /** The legend, and the height of its lines when they are broken at `width`. */
  const legend = (names, width, t, least = 2) => {
    if (names.length < least) return [{ show: false, data: names }, 0];
    let lines = 1;
    let filled = 0;
    for (const name of names) {
      const wide = Math.min(name.length * 6.4 + 48, width);
      if (filled + wide > width) {
        lines += 1;
        filled = 0;
      }
      filled += wide;
    }
    const many = lines > 5;
    const style = {
      data: names, left: 0, right: 0, top: 22, itemGap: 12, itemWidth: 22, itemHeight: 9, padding: 0, align: "left",
      type: many ? "scroll" : "plain", inactiveColor: t.rule, pageIconColor: t.quiet, pageTextStyle: { color: t.quiet },
      textStyle: { color: t.ink, fontSize: 12, width: width - 40, overflow: "truncate" },
    };
    return [style, (many ? 1 : lines) * 20];
  };
  const shown = (chart, name) => {
    const selected = chart.getOption().legend?.[0]?.selected;
    return !selected || selected[name] !== false;
  };
  /** An area between two curves, as one shape for each piece without a gap. */
  const band = (name, x, low, high, colour) => ({
    type: "custom", name, silent: true, clip: true, z: 3, progressive: 0, tooltip: { show: false },
    itemStyle: { color: colour }, encode: { x: 0, y: [1, 2] }, dimensions: ["x", "low", "high"],
    data: x.map((at, index) => [at, low[index], high[index]]),
    renderItem: (params, api) => {
      if (params.dataIndex !== 0) return null;
      const shapes = pieces(x, low, high).map((piece) => ({
        type: "polygon",
        shape: {
          points: [
            ...piece.map((index) => api.coord([x[index], low[index]])),
            ...piece.slice().reverse().map((index) => api.coord([x[index], high[index]])),
          ],
        },
        style: { fill: colour, opacity: 0.2, stroke: colour, lineWidth: 0.8 },
      }));
      return { type: "group", children: shapes };
    },
  });
  const coloured = (colour, t, extra) => ({
    type: "continuous", min: colour.from, max: colour.from === colour.to ? colour.from + 1 : colour.to, orient: "horizontal",
    left: "center", bottom: 4, itemWidth: 10, itemHeight: 150, calculable: false, hoverLink: false, inRange: { color: t.scale },
    text: [`${number(colour.to, 3)}${unit(colour)}`, `${colour.label} ${number(colour.from, 3)}`],
    textStyle: { color: t.quiet, fontSize: 12 }, padding: 0, ...extra,
  });
  const mix = (colours, share) => {
    const place = Math.max(0, Math.min(1, share)) * (colours.length - 1);
    return echarts.color.lerp(place % 1, [colours[Math.floor(place)], colours[Math.min(colours.length - 1, Math.floor(place) + 1)]]);
  };

  // ---- kinds -------------------------------------------------------------------------------------------------------
  const kinds = {};

  kinds.lines = (spec, t, size, chart) => {
    const colour = (index) => t.series[index % t.series.length];
    const names = spec.series.map((one) => one.name);
    const [key, keyHeight] = legend(names, size.width, t);
    key.data = spec.series.map(({ name, line }) =>
      spec.stacked ? { name, icon: "roundRect" } : line === "dots" ? { name, icon: "circle" } : { name, itemStyle: { opacity: 0 } });
    const bottom = spec.slider ? 76 : 44;
    const moments = spec.marks.some((one) => !one.level) ? 14 : 0;
    const grid = { left: size.narrow ? 48 : 58, right: 16, top: 28 + keyHeight + moments, bottom };
    const [low, high] = range(spec.series.flatMap((one) => [spec.x.from ?? null, spec.x.to ?? null, ...one.x].filter((x) => x !== null)));
    const pixels = (size.width - grid.left - grid.right) / (high - low || 1);
    const series = [];
    spec.series.forEach((one, index) => {
      // Colours begin again after the last; broken lines then keep the series apart.
      const again = index >= t.series.length ? "dashed" : "solid";
      const dots = one.line === "dots";
      series.push({
        type: dots ? "scatter" : "line", name: one.name, data: pairs(one.x, one.y), symbol: dots ? "circle" : "none", symbolSize: 4,
        color: colour(index), connectNulls: false, z: 2, emphasis: { disabled: true }, stack: spec.stacked ? "sum" : undefined,
        areaStyle: spec.stacked ? { opacity: 0.7, color: colour(index) } : undefined,
        lineStyle: { width: spec.stacked ? 0 : 1.6, type: one.line === "dashed" ? "dashed" : again, color: colour(index), opacity: spec.series.length > 1 ? 0.85 : 1 },
        itemStyle: { color: colour(index) },
      });
      if (one.low) series.push(band(one.name, one.x, one.low, one.high, colour(index)));
    });
    series.push({
      type: "line", data: [], silent: true, tooltip: { show: false },
      markArea: {
        silent: true, itemStyle: { color: t.shade },
        data: spec.intervals.map((one) => [
          {
            xAxis: one.from, name: one.label,
            label: { show: (one.to - one.from) * pixels > one.label.length * 6 + 4, color: t.quiet, fontSize: 11, position: "insideTop" },
          },
          { xAxis: one.to },
        ]),
      },
      markLine: {
        silent: true, symbol: "none", lineStyle: { color: t.quiet, type: "dotted", width: 1.4 },
        data: [...zero(range(spec.series.flatMap((one) => one.y)), t), ...spec.marks.map((one) => ({
          [one.level ? "yAxis" : "xAxis"]: one.at,
          label: {
            formatter: () => one.label, color: t.ink, fontSize: 11, position: one.level ? "insideEndTop" : "end", rotate: 0,
            textBorderColor: t.ground, textBorderWidth: 3,
          },
        }))],
      },
    });
    return {
      title: heading(titled(spec.y), t), legend: key, grid, xAxis: across(spec.x, t), yAxis: { ...upward(t), scale: !spec.stacked }, series,
      dataZoom: [
        {
          type: "slider", show: !!spec.slider, filterMode: "none", bottom: 6, height: 18, left: grid.left, right: grid.right,
          showDataShadow: false, brushSelect: false, borderColor: t.rule, fillerColor: t.shade, textStyle: { color: t.quiet, fontSize: 11 },
          showDetail: false, handleStyle: { color: t.ground, borderColor: t.quiet }, moveHandleSize: 0,
        },
        { type: "inside", filterMode: "none", zoomOnMouseWheel: "ctrl", moveOnMouseMove: "shift", moveOnMouseWheel: false },
      ],
      tooltip: {
        trigger: "axis", axisPointer: { type: "line", lineStyle: { color: t.quiet } },
        formatter: (params) => {
          const at = params[0]?.axisValue;
          if (at === undefined) return "";
          const inside = spec.intervals.filter((one) => one.from <= at && at <= one.to).map((one) => `<div>${escape(one.label)}</div>`);
          const rows = spec.series.map((one, index) => {
            const found = nearest(one.x, at);
            if (found < 0 || !shown(chart(), one.name)) return "";
            const limits = one.low ? ` (${number(one.low[found])} to ${number(one.high[found])})` : "";
            return row(colour(index), one.name, `${number(one.y[found])}${unit(spec.y)}${limits}`);
          });
          return `<div>${escape(`${spec.x.label} ${number(at, 6)}${unit(spec.x)}`)}</div>${inside.join("")}${rows.join("")}`;
        },
      },
    };
  };

  kinds.scatter = (spec, t, size) => {
    const names = spec.clouds.map((one) => one.name);
    const [key, keyHeight] = legend(names, size.width, t);
    const series = spec.clouds.map((one, index) => one.joined ? ({
      type: "line", name: one.name, symbol: "none", color: t.quiet, lineStyle: { color: t.quiet, width: 1.5, type: "dashed" }, z: 1,
      data: one.x.map((x, at) => [x, one.y[at], null]),
    }) : ({
      type: "scatter", name: one.name, symbol: ["circle", "triangle", "rect", "diamond"][index % 4], color: t.series[index % t.series.length],
      symbolSize: one.x.length > 800 ? 4 : 7, itemStyle: { opacity: 0.75 }, progressive: 0,
      data: one.x.map((x, at) => [x, one.y[at], one.colour ? one.colour[at] : null]),
    }));
    const line = zero(range(spec.clouds.flatMap((one) => one.y)), t);
    series.push({ type: "line", data: [], silent: true, tooltip: { show: false }, markLine: { silent: true, symbol: "none", data: line } });
    const tinted = spec.clouds.flatMap((one, index) => (one.colour ? [index] : []));
    return {
      title: heading(titled(spec.y), t), legend: key, series, xAxis: across(spec.x, t), yAxis: upward(t),
      grid: { left: size.narrow ? 48 : 58, right: 16, top: 26 + keyHeight, bottom: spec.colour ? 70 : 44 },
      visualMap: spec.colour ? coloured(spec.colour, t, { seriesIndex: tinted, dimension: 2 }) : undefined,
      tooltip: {
        trigger: "item",
        formatter: ({ seriesName, color, value: [x, y, third] }) =>
          row(color, seriesName, "") + row("transparent", spec.x.label, `${number(x)}${unit(spec.x)}`) +
          row("transparent", spec.y.label, `${number(y)}${unit(spec.y)}`) +
          (spec.colour && third !== null ? row("transparent", spec.colour.label, `${number(third)}${unit(spec.colour)}`) : ""),
      },
    };
  };

  kinds.bars = (spec, t, size) => {
    const names = spec.bars.map((one) => one.name);
    const [key, keyHeight] = legend(names, size.width, t);
    const gaps = { barGap: "12%", barCategoryGap: "28%" };
    const flat = spec.horizontal;
    const few = !spec.stacked && spec.categories.length * spec.bars.length <= 14;
    const series = [];
    spec.bars.forEach((one, index) => {
      const colour = t.series[index % t.series.length];
      series.push({
        type: "bar", name: one.name, data: one.values, ...gaps, stack: spec.stacked ? "sum" : undefined, itemStyle: { color: colour }, barMaxWidth: 56,
        label: {
          show: few && !one.low, position: flat ? "right" : "top", color: t.ink, fontSize: 11,
          formatter: ({ value }) => (value === null || value === undefined ? "" : number(value, 3)),
        },
      });
    });
    spec.bars.forEach((one, index) => {
      if (!one.low) return;
      const below = (at) => {
        if (!spec.stacked) return 0;
        const sign = Math.sign(one.values[at]);
        return spec.bars.slice(0, index).reduce((sum, other) => sum + (Math.sign(other.values[at]) === sign ? other.values[at] : 0), 0);
      };
      series.push({
        type: "custom", name: one.name, silent: true, z: 5, tooltip: { show: false }, itemStyle: { color: t.ink },
        encode: flat ? { y: 0, x: [1, 2] } : { x: 0, y: [1, 2] },
        data: spec.categories.map((_, at) => [at, one.low[at] === null ? null : one.low[at] + below(at), one.high[at] === null ? null : one.high[at] + below(at)]),
        renderItem: (params, api) => {
          const ends = [api.value(1), api.value(2)];
          if (!ends.every(Number.isFinite)) return null;
          const count = spec.stacked ? 1 : spec.bars.length;
          const layout = api.barLayout({ count, ...gaps, barMaxWidth: 56 })[spec.stacked ? 0 : index];
          const [from, to] = ends.map((end) => {
            const point = api.coord(flat ? [end, api.value(0)] : [api.value(0), end]);
            point[flat ? 1 : 0] += layout.offsetCenter;
            return point;
          });
          const cap = Math.min(6, layout.width / 3);
          const line = (a, b) => ({ type: "line", shape: { x1: a[0], y1: a[1], x2: b[0], y2: b[1] }, style: { stroke: t.ink, lineWidth: 1.4 } });
          const cross = (p) => (flat ? line([p[0], p[1] - cap], [p[0], p[1] + cap]) : line([p[0] - cap, p[1]], [p[0] + cap, p[1]]));
          return { type: "group", children: [line(from, to), cross(from), cross(to)] };
        },
      });
    });
    // Room for the names: measured roughly, broken where they are too long.
    const longest = Math.max(0, ...spec.categories.map((name) => name.length)) * 6.8 + 4;
    const room = flat ? size.width * 0.34 : Math.max(44, (size.width - 70) / Math.max(1, spec.categories.length) - 8);
    const wide = Math.floor(Math.min(longest, room));
    const lines = Math.min(4, Math.ceil(longest / room));
    const categories = {
      type: "category", data: spec.categories, inverse: flat, ...axisStyle(t), splitLine: { show: false }, axisTick: { show: false },
      axisLabel: { color: t.ink, fontSize: 12, interval: flat || spec.categories.length <= 12 ? 0 : "auto", width: wide, overflow: "break", lineHeight: 14, hideOverlap: spec.categories.length > 12 },
    };
    const values = { type: "value", ...axisStyle(t), splitNumber: size.narrow ? 3 : 5 };
    return {
      title: heading(titled(spec.axis), t), legend: key, series,
      grid: { left: flat ? wide + 12 : size.narrow ? 48 : 58, right: flat ? 40 : 12, top: 30 + keyHeight, bottom: flat ? 28 : 14 + 14 * lines },
      xAxis: flat ? values : categories, yAxis: flat ? categories : values,
      tooltip: {
        trigger: "axis", axisPointer: { type: "shadow" },
        formatter: (params) => {
          const at = params[0]?.dataIndex;
          if (at === undefined) return "";
          const rows = spec.bars.map((one, index) => {
            const limits = one.low && one.low[at] !== null ? ` (${number(one.low[at])} to ${number(one.high[at])})` : "";
            return row(t.series[index % t.series.length], one.name, `${number(one.values[at])}${unit(spec.axis)}${limits}`);
          });
          return `<div>${escape(spec.categories[at])}</div>${rows.join("")}`;
        },
      },
    };
  };

  kinds.sankey = (spec, t, size) => {
    const enters = (node) => spec.flows.filter((flow) => flow.to === node).reduce((sum, flow) => sum + flow.value, 0);
    const leaves = (node) => spec.flows.filter((flow) => flow.from === node).reduce((sum, flow) => sum + flow.value, 0);
    const whole = spec.nodes.filter((node) => !enters(node)).reduce((sum, node) => sum + leaves(node), 0);
    const amount = (value) => `${number(value, 4)}${unit(spec.axis)}, ${number((100 * value) / whole, 3)}\u202f%`;
    const label = { color: t.ink, fontSize: 12, lineHeight: 15, textBorderColor: t.ground, textBorderWidth: 3 };
    return {
      series: [
        {
          type: "sankey", left: 2, right: 2, top: 40, bottom: 24, nodeGap: 36, nodeWidth: 14, draggable: false, layoutIterations: 48,
          emphasis: { focus: "adjacency" }, lineStyle: { color: "gradient", opacity: 0.35, curveness: 0.5 },
          label: { ...label, formatter: ({ name }) => `${name}\n${amount(Math.max(enters(name), leaves(name)))}` },
          data: spec.nodes.map((name, index) => {
            const inner = enters(name) && leaves(name);
            return {
              name, itemStyle: { color: inner ? t.quiet : t.series[(spec.colours[name] ?? index) % t.series.length], borderWidth: 0 },
              label: { position: inner ? "top" : enters(name) ? "left" : "right", width: size.width * 0.42, overflow: "break" },
            };
          }),
          links: spec.flows.map((flow) => ({ source: flow.from, target: flow.to, value: flow.value })),
        },
      ],
      tooltip: {
        trigger: "item",
        formatter: ({ dataType, data, name, color }) =>
          dataType === "edge"
            ? row("transparent", `${data.source} → ${data.target}`, amount(data.value))
            : row(color, name, amount(Math.max(enters(name), leaves(name)))),
      },
    };
  };

  kinds.cumulative = (spec, t, size, chart) => {
    const names = spec.series.map((one) => one.name);
    const [key, keyHeight] = legend(names, size.width, t);
    key.data = names.map((name) => ({ name, itemStyle: { opacity: 0 } }));
    // A value holds from its own place to the next one.
    const stepped = (x, y) => {
      const points = { x: [], y: [] };
      x.forEach((at, index) => {
        if (index > 0) {
          points.x.push(at);
          points.y.push(y[index - 1]);
        }
        points.x.push(at);
        points.y.push(y[index]);
      });
      return points;
    };
    const series = spec.series.flatMap((one, index) => {
      const colour = t.series[index % t.series.length];
      const line = {
        type: "line", name: one.name, data: one.x.length ? [[one.x[0], 0], ...pairs(one.x, one.y)] : [], step: "end", symbol: "none", color: colour, z: 2,
        lineStyle: { width: 1.6, color: colour, type: index % 2 ? [7, 3] : "solid" }, emphasis: { disabled: true },
      };
      if (!one.low) return [line];
      const low = stepped(one.x, one.low);
      const high = stepped(one.x, one.high);
      return [line, band(one.name, low.x, low.y, high.y, colour)];
    });
    return {
      title: heading(titled(spec.y), t), legend: key, series, xAxis: across(spec.x, t), yAxis: { ...upward(t), min: 0, max: 1, interval: 0.2 },
      grid: { left: size.narrow ? 48 : 58, right: 16, top: 26 + keyHeight, bottom: 44 },
      tooltip: {
        trigger: "axis", axisPointer: { type: "line", lineStyle: { color: t.quiet } },
        formatter: (params) => {
          const at = params[0]?.axisValue;
          if (at === undefined) return "";
          const rows = spec.series.map((one, index) => {
            if (!shown(chart(), one.name)) return "";
            let found = nearest(one.x, at);
            if (found >= 0 && one.x[found] > at) found -= 1;
            const limits = found >= 0 && one.low ? ` (${number(one.low[found], 3)} to ${number(one.high[found], 3)})` : "";
            return row(t.series[index % t.series.length], one.name, `${found < 0 ? 0 : number(one.y[found], 3)}${limits}`);
          });
          return `<div>${escape(`${spec.x.label} ≤ ${number(at)}${unit(spec.x)}`)}</div>${rows.join("")}`;
        },
      },
    };
  };

  kinds.map = (spec, t, size) => {
    const names = spec.highlights.map((one) => one.label);
    const [key, keyHeight] = legend(names, size.width, t, 1);
    key.data = names.map((name) => ({ name, icon: "roundRect" }));
    const grid = size.grid(keyHeight);
    const path = pieces(spec.east, spec.north);
    const place = (index) => [spec.east[index], spec.north[index]];
    const tint = (index) =>
      spec.values && spec.values[index] !== null
        ? mix(t.scale, Math.round(((spec.values[index] - spec.colour.from) / (spec.colour.to - spec.colour.from || 1)) * 31) / 31)
        : spec.values ? t.rule : t.series[0];
    // Steps of one colour are one line.
    const strokes = path.flatMap((piece) => {
      const found = [];
      for (let at = 1; at < piece.length; at++) {
        const colour = tint(piece[at - 1]);
        const last = found.at(-1);
        if (last && last.colour === colour) last.indices.push(piece[at]);
        else found.push({ colour, indices: [piece[at - 1], piece[at]] });
      }
      return found;
    });
    const thick = ["#e69f00", "#cc79a7", "#56b4e9", "#999999"];
    const all = path.flat();
    const [[west, farEast], [south, farNorth]] = [range(spec.east), range(spec.north)];
    const tall = farNorth - south > 1.5 * (farEast - west);
    const marks = all.length ? [["start", all[0], "circle", "left"], ["end", all.at(-1), "rect", "right"]] : [];
    const series = spec.highlights.map((one, index) => ({
      type: "line", name: one.label, data: pairs(one.east, one.north), symbol: "none", silent: true, z: 1, color: thick[index % 4],
      lineStyle: { width: 13, opacity: 0.5, cap: "round", join: "round", color: thick[index % 4] }, tooltip: { show: false },
    }));
    series.push(
      {
        type: "custom", name: "path", silent: true, clip: true, z: 2, progressive: 0, color: t.series[0], encode: { x: 0, y: 1 },
        data: all.map(place),
        renderItem: (params, api) =>
          params.dataIndex !== 0 ? null : {
            type: "group",
            children: strokes.map(({ colour, indices }) => ({
              type: "polyline", shape: { points: indices.map((index) => api.coord(place(index))) },
              style: { stroke: colour, lineWidth: 3, fill: null, lineCap: "round", lineJoin: "round" },
            })),
          },
      },
      {
        type: "scatter", name: "arrows", silent: true, z: 3, symbol: "path://M0,-8 L6,7 L0,3 L-6,7 Z", symbolSize: 12,
        itemStyle: { color: t.ink, borderColor: t.ground, borderWidth: 1 },
        data: (spec.arrows ?? []).map(([east, north, heading]) => ({ value: [east, north], symbolRotate: -heading })),
      },
      {
        type: "scatter", name: "ends", z: 4, silent: true, itemStyle: { color: t.ground, borderColor: t.ink, borderWidth: 2 },
        data: marks.map(([name, index, symbol, side]) => ({
          value: place(index), symbol, symbolSize: 11,
          label: { show: true, formatter: () => name, position: tall ? "right" : side === "left" ? "top" : "bottom", color: t.ink, fontSize: 12, textBorderColor: t.ground, textBorderWidth: 3 },
        })),
      },
      {
        // Not to be seen: carries the tooltips and the colour scale.
        type: "scatter", name: "places", z: 5, symbolSize: 10, progressive: 0, itemStyle: { opacity: 0 }, emphasis: { disabled: true },
        data: all.map((index) => [...place(index), spec.values ? spec.values[index] : null]),
      },
    );
    const [east, north] = size.equal(all.map((index) => spec.east[index]), all.map((index) => spec.north[index]), grid);
    const zoom = { type: "inside", filterMode: "none", zoomOnMouseWheel: "ctrl", moveOnMouseMove: "shift", moveOnMouseWheel: false };
    return {
      title: heading(`north [${spec.unit}]`, t), legend: key, grid, series,
      xAxis: { ...across({ label: "east", unit: spec.unit, from: east[0], to: east[1] }, t), splitLine: { show: true, lineStyle: { color: t.fine } }, splitNumber: size.narrow ? 3 : 6, axisLabel: edgeless(t) },
      yAxis: { ...upward(t), min: north[0], max: north[1], axisLabel: edgeless(t) },
      dataZoom: [{ ...zoom, xAxisIndex: 0 }, { ...zoom, yAxisIndex: 0 }],
      visualMap: spec.colour ? coloured(spec.colour, t, { seriesIndex: series.length - 1, dimension: 2 }) : undefined,
      tooltip: {
        trigger: "item",
        formatter: ({ value }) =>
          row("transparent", "east", `${number(value[0])}\u00a0${spec.unit}`) + row("transparent", "north", `${number(value[1])}\u00a0${spec.unit}`) +
          (spec.colour && value[2] !== null ? row("transparent", spec.colour.label, `${number(value[2])}${unit(spec.colour)}`) : ""),
      },
    };
  };
  /** Labels of an axis whose ends are no round numbers. */
  const edgeless = (t) => ({ ...axisStyle(t).axisLabel, showMinLabel: false, showMaxLabel: false });

  kinds.heat = (spec, t, size) => {
    const data = spec.values.flatMap((values, y) => values.map((value, x) => [x, y, value]));
    const longest = (names) => Math.max(0, ...names.map((name) => name.length)) * 6.8 + 4;
    const margin = Math.min(longest(spec.rows), size.width * 0.32);
    const cell = (size.width - margin) / Math.max(1, spec.columns.length);
    const turned = longest(spec.columns) > cell;
    const style = { type: "category", ...axisStyle(t), splitLine: { show: false }, axisTick: { show: false }, axisLine: { show: false } };
    const label = { color: t.ink, fontSize: 12, interval: 0 };
    return {
      grid: { left: margin + 10, right: 12, top: 6, bottom: turned ? 44 + Math.min(90, longest(spec.columns) * 0.68) : 66 },
      xAxis: { ...style, data: spec.columns, axisLabel: { ...label, rotate: turned ? 40 : 0, width: turned ? 120 : cell, overflow: turned ? "truncate" : "break" } },
      yAxis: { ...style, data: spec.rows, inverse: true, axisLabel: { ...label, width: margin, overflow: "break", lineHeight: 14 } },
      visualMap: coloured({ label: spec.axis.label, unit: spec.axis.unit, from: -spec.limit, to: spec.limit }, t, { inRange: { color: t.sides } }),
      series: [
        {
          type: "heatmap", itemStyle: { borderColor: t.ground, borderWidth: 2 },
          data: data.map(([x, y, value]) => {
            const strong = Math.abs(value ?? 0) > 0.72 * spec.limit;
            return { value: [x, y, value ?? "-"], label: { color: strong ? t.ground : t.ink } };
          }),
          label: { show: cell > 36, fontSize: 12, formatter: ({ value }) => (value[2] === "-" ? "–" : number(value[2], 2)) },
        },
      ],
      tooltip: {
        trigger: "item",
        formatter: ({ value }) => row("transparent", `${spec.rows[value[1]]} with ${spec.columns[value[0]]}`, `${number(value[2], 4)}${unit(spec.axis)}`),
      },
    };
  };

  // ---- sizes -------------------------------------------------------------------------------------------------------
  /** Width of a plot; its height is set here where its content asks for one. */
  const measured = (spec, element, paper) => {
    const width = paper ?? element.clientWidth;
    const narrow = width < 520;
    const size = { width, narrow };
    if (spec.kind === "sankey") {
      const ends = Math.max(
        spec.nodes.filter((node) => !spec.flows.some((flow) => flow.to === node)).length,
        spec.nodes.filter((node) => !spec.flows.some((flow) => flow.from === node)).length,
      );
      size.height = Math.max(260, 190 + 40 * ends);
    } else if (spec.kind === "bars" && spec.horizontal) {
      size.height = 60 + 20 * Math.min(3, spec.bars.length) + spec.categories.length * (22 + (spec.stacked ? 8 : 14 * spec.bars.length));
    } else if (spec.kind === "heat") {
      size.height = Math.min(640, 130 + 44 * spec.rows.length);
    } else if (spec.kind === "lines" && spec.slider) {
      size.height = (narrow ? 300 : 340) + 32;
    } else if (spec.kind === "map") {
      size.grid = (key) => ({ left: narrow ? 48 : 58, right: 18, top: 26 + key, bottom: spec.colour ? 70 : 44 });
      const grid = size.grid(spec.highlights.length ? 20 : 0);
      const [east, north] = [range(spec.east), range(spec.north)];
      const shape = (north[1] - north[0]) / (east[1] - east[0] || 1);
      const inner = Math.min(narrow ? 420 : 520, Math.max(120, (width - grid.left - grid.right) * (Number.isFinite(shape) ? shape : 1) * 1.1));
      size.height = Math.round(inner + grid.top + grid.bottom);
      // Both axes get as many metres a pixel as the fuller one needs.
      size.equal = (easts, norths, used) => {
        const [e, n] = [range(easts), range(norths)];
        if (!finite(easts).length) return [[0, 1], [0, 1]];
        const [w, h] = [width - used.left - used.right, size.height - used.top - used.bottom];
        const scale = 1.08 * Math.max((e[1] - e[0]) / w, (n[1] - n[0]) / h, 1e-6);
        const around = ([low, high], pixels) => [(low + high) / 2 - (scale * pixels) / 2, (low + high) / 2 + (scale * pixels) / 2];
        return [around(e, w), around(n, h)];
      };
    }
    if (size.height) element.style.height = `${size.height}px`;
    return size;
  };

  // ---- drawing -----------------------------------------------------------------------------------------------------
  const last = {};
  specs.forEach((spec, index) => {
    spec.empty = [spec.series, spec.clouds].some((all) => all && !all.some((one) => finite(one.y).length)) || (spec.east && !finite(spec.east).length);
    if (spec.kind === "lines" && !spec.empty) last[spec.linked ?? `own${index}`] = spec;
  });
  Object.values(last).forEach((spec) => (spec.slider = true));

  const charts = specs.map((spec, index) => ({ spec, element: document.getElementById(`p${index}`), chart: null }));
  const draw = (one, paper) => {
    const size = measured(one.spec, one.element, paper);
    const t = theme();
    const zoom = one.chart?.getOption()?.dataZoom?.map(({ start, end }) => ({ start, end }));
    if (!one.chart) {
      one.chart = echarts.init(one.element, null, { renderer: "svg" });
      if (one.spec.kind === "lines") zoomable(one);
      if (one.spec.kind === "map") one.chart.getZr().on("dblclick", () => wide(one.chart));
    } else {
      one.chart.resize({ width: paper ?? "auto", height: size.height ?? "auto" });
    }
    const style = base(t);
    if (one.spec.empty) {
      style.graphic = [{ type: "text", left: "center", top: "middle", style: { text: "No values", fill: t.quiet, fontSize: 14 } }];
    }
    const option = kinds[one.spec.kind](one.spec, t, size, () => one.chart);
    if (zoom) option.dataZoom?.forEach((each, index) => Object.assign(each, zoom[index]));
    one.chart.setOption({ ...style, ...option, tooltip: { ...style.tooltip, ...option.tooltip } }, true);
    if (one.spec.linked) one.chart.group = one.spec.linked;
    if (zoom && one.spec.kind === "lines") fit(one);
  };
  const wide = (chart) => [0, 1].forEach((dataZoomIndex) => chart.dispatchAction({ type: "dataZoom", dataZoomIndex, start: 0, end: 100 }));

  /** The vertical axis follows what is seen of the curves. */
  const fit = ({ spec, chart }) => {
    const [{ start, end, startValue, endValue }] = chart.getOption().dataZoom;
    const whole = start <= 0 && end >= 100;
    // The ends of a part are no round numbers: not worth a label.
    const labels = whole ? labelled(spec.x) : { showMinLabel: false, showMaxLabel: false };
    chart.setOption({ xAxis: { axisLabel: labels } });
    if (spec.stacked) return undefined;
    if (whole) return chart.setOption({ yAxis: { min: null, max: null, interval: null } });
    const values = spec.series.flatMap((one) =>
      one.x.flatMap((x, at) => (x < startValue || x > endValue ? [] : [one.y[at], one.low?.[at] ?? null, one.high?.[at] ?? null])));
    const [low, high] = range(values);
    if (low > high) return undefined;
    const [min, max] = rounded(low, high);
    return chart.setOption({ yAxis: { min, max, interval: stride(low, high) } });
  };
  /** Drag across a plot to zoom, double-click to see all. Fingers scroll the page. */
  const zoomable = (one) => {
    const { chart } = one;
    const surface = chart.getZr();
    let from = null;
    let box = null;
    chart.on("datazoom", () => fit(one));
    surface.on("mousedown", ({ offsetX, offsetY, event }) => {
      if (event.zrByTouch || event.shiftKey || !chart.containPixel({ gridIndex: 0 }, [offsetX, offsetY])) return;
      from = offsetX;
    });
    surface.on("mousemove", ({ offsetX }) => {
      if (from === null) return;
      const grid = chart.getModel().getComponent("grid").coordinateSystem.getRect();
      const shape = { x: Math.min(from, offsetX), y: grid.y, width: Math.abs(offsetX - from), height: grid.height };
      if (!box) surface.add((box = new echarts.graphic.Rect({ shape, silent: true, z: 50, style: { fill: theme().shade } })));
      else box.setShape(shape);
    });
    const release = ({ offsetX }) => {
      if (box) surface.remove(box);
      if (from !== null && Math.abs(offsetX - from) > 6) {
        const ends = [from, offsetX].map((x) => chart.convertFromPixel({ xAxisIndex: 0 }, x)).sort((a, b) => a - b);
        chart.dispatchAction({ type: "dataZoom", dataZoomIndex: 0, startValue: ends[0], endValue: ends[1] });
      }
      from = box = null;
    };
    surface.on("mouseup", release);
    surface.on("globalout", () => {
      if (box) surface.remove(box);
      from = box = null;
    });
    surface.on("dblclick", () => wide(chart));
  };

  // ---- pictures ----------------------------------------------------------------------------------------------------
  const file = (spec, ending) => `${spec.title.replace(/[^\p{L}\p{N}]+/gu, "_").replace(/^_|_$/g, "") || "plot"}.${ending}`;
  const save = (name, address) => Object.assign(document.createElement("a"), { href: address, download: name }).click();
  const asSvg = (one) => save(file(one.spec, "svg"), one.chart.getDataURL({ type: "svg" }));
  const asPng = (one) => {
    const picture = new Image();
    picture.onload = () => {
      const canvas = document.createElement("canvas");
      canvas.width = 2 * one.chart.getWidth();
      canvas.height = 2 * one.chart.getHeight();
      canvas.getContext("2d").drawImage(picture, 0, 0, canvas.width, canvas.height);
      save(file(one.spec, "png"), canvas.toDataURL("image/png"));
    };
    picture.src = one.chart.getDataURL({ type: "svg" });
  };
  const button = (one, words, about, act) => {
    const made = Object.assign(document.createElement("button"), { type: "button", textContent: words, title: about });
    made.setAttribute("aria-label", `${about}: ${one.spec.title}`);
    made.addEventListener("click", () => one.chart && act(one));
    return made;
  };
  charts.forEach((one, index) => {
    const holder = document.querySelector(`.buttons[data-for="${index}"]`);
    if (one.spec.kind === "lines") holder.append(button(one, "All", "See the whole range", () => wide(one.chart)));
    holder.append(button(one, "SVG", "Save as SVG", asSvg), button(one, "PNG", "Save as PNG", asPng));
  });

  // ---- life of the page --------------------------------------------------------------------------------------------
  /** Draws a plot; one that fails leaves the others standing. */
  const attempt = (one, paper) => {
    try {
      draw(one, paper);
    } catch (error) {
      console.error(`${one.spec.title}: ${error.stack ?? error}`);
    }
  };
  // A page of hundreds of plots takes seconds: it is drawn from the top in short turns, and can be read meanwhile.
  let turn = 0;
  const all = () => {
    clearTimeout(turn);
    document.body.dataset.drawn = "part";
    const waiting = charts.slice();
    const some = () => {
      const until = performance.now() + 50;
      while (waiting.length && performance.now() < until) attempt(waiting.shift());
      if (waiting.length) turn = setTimeout(some, 0);
      else document.body.dataset.drawn = "all";
    };
    some();
  };
  all();
  [...new Set(specs.map((spec) => spec.linked).filter(Boolean))].forEach((group) => echarts.connect(group));
  dark.addEventListener("change", () => all());
  let waiting;
  let width = document.documentElement.clientWidth;
  window.addEventListener("resize", () => {
    if (document.documentElement.clientWidth === width) return;
    width = document.documentElement.clientWidth;
    clearTimeout(waiting);
    waiting = setTimeout(() => all(), 120);
  });
  window.addEventListener("beforeprint", () => {
    printing = true;
    clearTimeout(turn);
    charts.forEach((one) => attempt(one, 680));
  });
  window.addEventListener("afterprint", () => {
    printing = false;
    all();
  });
})();
