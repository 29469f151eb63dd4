// Colours that the colour-blind tell apart (Okabe and Ito, 2008), and those of the theme.

const LINES = ['#0072b2', '#d55e00', '#009e73', '#cc79a7', '#e69f00', '#56b4e9'];
const LINES_ON_DARK = ['#56b4e9', '#ff8a3d', '#2fd0a0', '#e79ac3', '#f0c040', '#9fd3f5'];

export function isDark() {
  return document.documentElement.dataset.theme === 'dark';
}

export function lineColour(index) {
  return (isDark() ? LINES_ON_DARK : LINES)[index % LINES.length];
}

export function themeColour(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
}

// Cividis (Nuñez, Anderton and Renslow, 2018) at nine places: rising lightness for any eye.
const CIVIDIS = [
  [0, 32, 76], [0, 48, 110], [61, 66, 108], [87, 85, 109], [111, 105, 112],
  [136, 126, 117], [165, 148, 111], [201, 176, 94], [255, 234, 70],
];

/** Colour of a share from 0 to 1. */
export function mapColour(share) {
  const place = Math.min(Math.max(share, 0), 1) * (CIVIDIS.length - 1);
  const index = Math.min(Math.floor(place), CIVIDIS.length - 2);
  const part = place - index;
  return CIVIDIS[index].map((low, i) => Math.round(low + part * (CIVIDIS[index + 1][i] - low)));
}
