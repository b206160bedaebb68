"""The paper's own method: circles of sections, and a solid through them."""
