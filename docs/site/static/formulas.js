for (const formula of document.querySelectorAll(".math")) renderMathInElement(formula);
