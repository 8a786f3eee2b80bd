"""From sound to candidates: one streamed pass, levels and tiles, then metres, background and peaks."""
