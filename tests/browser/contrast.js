// Texts that stand out from what is behind them by less than they should, by WCAG 2.1, 1.4.3: [text, contrast, least].
// https://www.w3.org/TR/WCAG21/#dfn-contrast-ratio
() => {
  const rgba = text => {
    const canvas = document.createElement("canvas").getContext("2d", { willReadFrequently: true });
    canvas.fillStyle = text;
    canvas.fillRect(0, 0, 1, 1);
    const [r, g, b, a] = canvas.getImageData(0, 0, 1, 1).data;
    return [r, g, b, a / 255];
  };
  const over = ([r, g, b, a], under) => [r, g, b].map((value, at) => a * value + (1 - a) * under[at]);
  const linear = value => (value /= 255) <= 0.04045 ? value / 12.92 : ((value + 0.055) / 1.055) ** 2.4;
  const luminance = color => 0.2126 * linear(color[0]) + 0.7152 * linear(color[1]) + 0.0722 * linear(color[2]);
  const found = [];
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  for (let node; (node = walker.nextNode());) {
    const text = node.data.trim(), element = node.parentElement, style = getComputedStyle(element);
    if (!text || ["STYLE", "SCRIPT"].includes(element.tagName) || !element.checkVisibility({ checkVisibilityCSS: true })) continue;
    const chain = [];
    for (let parent = element; parent; parent = parent.parentElement) chain.unshift(parent);
    let behind = [255, 255, 255], color = rgba(style.color), opacity = 1;
    for (const parent of chain) {
      const own = getComputedStyle(parent), layer = rgba(own.backgroundColor);
      opacity *= Number(own.opacity);
      behind = over([layer[0], layer[1], layer[2], layer[3] * opacity], behind);
    }
    const shown = over([color[0], color[1], color[2], color[3] * opacity], behind);
    const [low, high] = [luminance(shown), luminance(behind)].sort((a, b) => a - b);
    const size = parseFloat(style.fontSize), large = size >= 24 || (size >= 18.66 && Number(style.fontWeight) >= 700);
    const contrast = (high + 0.05) / (low + 0.05), least = large ? 3 : 4.5;
    if (contrast < least) found.push([text.slice(0, 40), Math.round(100 * contrast) / 100, least, element.className.slice(0, 80)]);
  }
  return found;
}
