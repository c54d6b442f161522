"""What `dem check` says that runs cost, beside what they cost: seeded cases of every kind of analysis."""
