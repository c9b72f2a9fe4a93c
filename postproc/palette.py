"""Colours of curves and bodies."""

#: Distinguishable also without red-green vision (after Okabe & Ito 2008), darkened where white paper asks for it.
COLOURS = ("#0b6fb3", "#d4581a", "#1a8f6a", "#a8468c", "#d99a00", "#4aa5d8", "#6b6f76", "#7a4f2a")
INK, FAINT = "#22272e", "#c9ced6"
WATER = "#2f86c8"
#: From the first to the last of many, dark blue, blue, green, ochre, gold.
SCALE = ("#2b2a6b", "#0b6fb3", "#1a8f6a", "#b0741a", "#d9b310")
