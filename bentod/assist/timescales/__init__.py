"""How far ahead an assist looks: chosen, blended or made part of the question, by reward (thesis 6.3)."""
