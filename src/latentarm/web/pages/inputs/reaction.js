/**
 * Nobody answers what they see sooner, ms. Simple reactions to a light take a mean of 231 ms on a computer, of 1469 people
 * (Woods, Wyma, Yund, Herron and Reed, Frontiers in Human Neuroscience 9:131, 2015); to choose takes longer.
 */
export const REACTION_MS = 200;
